#!/usr/bin/env python3
"""Reads a page in Chromium, as its readers do: on a narrow and a wide screen, and on paper.

    scripts/readers/page.py REPORT.html [-o DIR]

Prints what is wrong: errors on the console, requests, text that overlaps, is cut or too small, a page that is wider than the screen; in print
words beyond the paper, headings at the foot of a sheet, folds that stay closed. Ends with status 1 then. With -o the pictures stay in DIR.
Needs chromium and poppler-utils.
"""

import argparse
import base64
import fcntl
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

# Screens: width and height in CSS pixels, device pixels for each.
SCREENS = [(360, 740, 2), (1280, 800, 1)]

# What is wrong with the texts of a page, found where the browser has laid them out.
INSPECT = r"""
(() => {
  const faults = [], texts = [];
  const width = document.documentElement.clientWidth;
  const across = document.documentElement.scrollWidth;
  if (across > width) faults.push(`the page is ${across} px wide on a screen of ${width} px`);
  if (document.scripts.length) faults.push("the page has scripts");
  for (const element of document.body.querySelectorAll("*")) {
    if (element.namespaceURI.endsWith("xhtml") && element.checkVisibility() && element.scrollWidth > element.clientWidth + 1
        && getComputedStyle(element).overflowX !== "visible" && element.clientWidth > 0)
      faults.push(`<${element.localName} class="${element.className}"> has ${element.scrollWidth} px in ${element.clientWidth} px`);
  }
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const range = document.createRange();
  while (walker.nextNode()) {
    const node = walker.currentNode, parent = node.parentElement;
    if (!node.data.trim() || !parent.checkVisibility({ contentVisibilityAuto: true, visibilityProperty: true })) continue;
    range.selectNodeContents(node);
    const svg = parent.ownerSVGElement, matrix = svg && parent.getScreenCTM();
    const size = parseFloat(getComputedStyle(parent).fontSize) * (matrix ? Math.hypot(matrix.a, matrix.b) : 1);
    const label = node.data.trim().slice(0, 40);
    if (size < 10) faults.push(`letters of ${size.toFixed(1)} px: ${label}`);
    for (const r of range.getClientRects()) {
      if (r.width < 1) continue;
      if (r.left < -0.5 || r.right > width + 0.5) faults.push(`beyond the screen: ${label}`);
      if (svg) {
        const s = svg.getBoundingClientRect();
        if (r.left < s.left - 1 || r.right > s.right + 1 || r.top < s.top - 0.2 * size || r.bottom > s.bottom + 0.2 * size)
          faults.push(`cut by its figure: ${label}`);
      }
      // Letters take the middle of a line's height.
      const rim = svg && Math.abs(matrix.b) > Math.abs(matrix.a) ? [0.2 * r.width, 0] : [0, 0.2 * r.height];
      texts.push({ left: r.left + rim[0], right: r.right - rim[0], top: r.top + rim[1], bottom: r.bottom - rim[1], label,
                   cell: parent.closest("td, th") });
    }
  }
  texts.sort((a, b) => a.top - b.top);
  for (let i = 0; i < texts.length; i++)
    for (let j = i + 1; j < texts.length && texts[j].top < texts[i].bottom - 1; j++)
    {
      // Cells side by side are kept apart; other texts must not overlap.
      const gap = texts[i].cell && texts[j].cell && texts[i].cell !== texts[j].cell ? 4 : -1;
      if (texts[i].left < texts[j].right + gap && texts[j].left < texts[i].right + gap)
        faults.push(`overlap: ${texts[i].label} | ${texts[j].label}`);
    }
  return { faults, texts: texts.length, height: Math.ceil(document.documentElement.scrollHeight) };
})()
"""


class Browser:
    """Chromium without a window, spoken to by its DevTools protocol through a pair of pipes."""

    def __init__(self, folder):
        to_browser, self.to = os.pipe()
        self.of, from_browser = os.pipe()
        # Out of the way of the numbers that Chromium wants: 3 to read, 4 to write.
        ends = [fcntl.fcntl(end, fcntl.F_DUPFD, 10) for end in (to_browser, from_browser)]
        options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars", "--no-first-run",
                   "--disable-background-networking", "--disable-component-update", f"--user-data-dir={folder}",
                   "--remote-debugging-pipe", "about:blank"]

        def connect():
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        self.process = subprocess.Popen(["chromium", *options], pass_fds=(3, 4), preexec_fn=connect, stdin=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for end in [to_browser, from_browser, *ends]:
            os.close(end)
        self.buffer, self.number, self.events, self.session = b"", 0, [], None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ["Page", "Runtime", "Log", "Network"]:
            self.call(f"{domain}.enable")

    def receive(self):
        """The next message."""
        while b"\0" not in self.buffer:
            part = os.read(self.of, 1 << 20)
            if not part:
                sys.exit("Chromium has ended")
            self.buffer += part
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, **parameters):
        """Does something and waits for the answer; events meanwhile are kept."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.number:
                if "error" in answer:
                    sys.exit(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.events.append(answer)

    def wait_for(self, event):
        """Until an event has come since the last wait."""
        while not any(message.get("method") == event for message in self.events):
            self.events.append(self.receive())

    def open(self, address):
        """Opens a page in the one tab; returns what is wrong with its loading."""
        self.events.clear()
        self.call("Page.navigate", url=address)
        self.wait_for("Page.loadEventFired")
        self.call("Runtime.evaluate", expression="document.fonts.ready", awaitPromise=True)
        faults = []
        for event in self.events:
            method, of = event.get("method"), event.get("params", {})
            if method in ("Runtime.exceptionThrown", "Runtime.consoleAPICalled", "Log.entryAdded"):
                faults.append(f"console: {json.dumps(of)[:200]}")
            if method == "Network.requestWillBeSent" and of["request"]["url"] != address:
                faults.append(f"request: {of['request']['url'][:80]}")
        return faults

    def close(self):
        """Ends the browser."""
        self.session = None
        self.call("Browser.close")
        self.process.wait()


def on_screen(browser, address, screen, folder):
    """What is wrong with a page on a screen, with a picture of it."""
    width, height, scale = screen
    browser.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=width < 600)
    faults = browser.open(address)
    found = browser.call("Runtime.evaluate", expression=INSPECT, returnByValue=True)["result"]["value"]
    clip = {"x": 0, "y": 0, "width": width, "height": found["height"], "scale": 1}
    picture = browser.call("Page.captureScreenshot", format="png", captureBeyondViewport=True, clip=clip)
    (folder / f"screen-{width}.png").write_bytes(base64.b64decode(picture["data"]))
    if found["texts"] < 50:
        faults.append(f"only {found['texts']} texts are seen")
    return [f"at {width} px: {fault}" for fault in [*faults, *found["faults"]]]


def in_print(browser, address, folder):
    """What is wrong with a page on paper, with its PDF."""
    browser.call("Emulation.clearDeviceMetricsOverride")
    browser.open(address)
    read = "JSON.stringify([[...document.querySelectorAll('h1,h2')].map(e => e.textContent), [...document.querySelectorAll('details')].map(e => e.textContent)])"
    headings, folds = json.loads(browser.call("Runtime.evaluate", expression=read)["result"]["value"])
    pdf = folder / "print.pdf"
    pdf.write_bytes(base64.b64decode(browser.call("Page.printToPDF", preferCSSPageSize=True)["data"]))
    text = subprocess.run(["pdftotext", "-bbox", pdf, "-"], capture_output=True, check=True, text=True).stdout
    root = xml.etree.ElementTree.fromstring(text[text.index("<html"):])
    faults, all_words = [], []
    pages = [element for element in root.iter() if element.tag.endswith("page")]
    for number, page in enumerate(pages, 1):
        width, height = float(page.get("width")), float(page.get("height"))
        words = [(word.text or "", *(float(word.get(of)) for of in ["xMin", "yMin", "xMax", "yMax"])) for word in page]
        all_words += words
        faults += [f"page {number}: {word} is beyond the paper" for word, left, top, right, bottom in words
                   if left < 20 or right > width - 20 or top < 20 or bottom > height - 10]
        # A section's heading is larger than all else on the page but the title.
        faults += [f"page {number}: the heading {word} is at the foot" for word, _, top, _, bottom in words
                   if bottom - top > 16 and top > 0.9 * height]
        if len(words) < 12 and number < len(pages):
            faults.append(f"page {number} is nearly empty")
    # Word by word: what stands in columns comes in another order, and long words are broken.
    printed = {word for word, *_ in all_words}
    missing = lambda text: [word for word in text.split() if word not in printed and len(word) < 20]
    faults += [f"{missing(heading)[0]} of the heading {heading!r} is not printed" for heading in headings if missing(heading)]
    faults += [f"of a fold is not printed: {missing(fold)[0]}" for fold in folds if missing(fold)]
    return [f"in print: {fault}" for fault in faults]


def main():
    """Reads the page that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("page", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, metavar="DIR", help="keep the pictures here")
    arguments = parser.parse_args()
    address = arguments.page.resolve().as_uri()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        pictures = arguments.output or pathlib.Path(folder)
        pictures.mkdir(parents=True, exist_ok=True)
        browser = Browser(pathlib.Path(folder) / "profile")
        faults = [fault for screen in SCREENS for fault in on_screen(browser, address, screen, pictures)]
        faults += in_print(browser, address, pictures)
        browser.close()
    print("\n".join(faults) or "nothing is wrong")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
