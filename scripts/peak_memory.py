"""peak_memory.py FILE COMMAND...: runs the command and writes the largest resident set of it, in bytes, to FILE.RANK.

To be started under mpirun, once a rank. The command's exit status is passed on.
"""

import os
import resource
import subprocess
import sys

rank = os.environ.get("OMPI_COMM_WORLD_RANK", "0")
status = subprocess.run(sys.argv[2:], check=False).returncode
with open(f"{sys.argv[1]}.{rank}", "w", encoding="ascii") as file:
    file.write(str(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024))
sys.exit(status if status >= 0 else 128 - status)
