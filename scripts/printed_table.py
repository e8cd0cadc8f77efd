"""printed_table.py DOC NAME: puts the Markdown table of what is read between <!-- NAME --> and <!-- /NAME --> in DOC."""

import sys

from markers import replace

# The first line may come behind the name of the test.
lines = [line[line.index("| ") :].strip() for line in sys.stdin if line.startswith("|") or "... | " in line]
if not lines:
    raise SystemExit("there is no table in what was printed")
replace(sys.argv[1], sys.argv[2], "\n".join(lines))
