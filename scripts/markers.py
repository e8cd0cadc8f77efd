"""Puts what a script has made between two comments of a Markdown file."""

import re


def replace(path, name, text):
    """Replaces what is between <!-- NAME --> and <!-- /NAME --> in a file, which must have both."""
    with open(path, encoding="utf-8") as file:
        whole = file.read()
    between = re.compile(rf"(<!-- {name} -->\n).*?(<!-- /{name} -->)", re.DOTALL)
    whole, count = between.subn(lambda found: f"{found[1]}\n{text.strip()}\n\n{found[2]}", whole)
    if count != 1:
        raise SystemExit(f"{path}: {count} places for {name} in the place of one")
    with open(path, "w", encoding="utf-8") as file:
        file.write(whole)


def table(head, rows):
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)
