"""Runs the program as a subprocess."""

from __future__ import annotations

import logging
import os
import re
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from typing import Any, Optional, Union

from .results import Run
from .toml import document, value

Scene = Union[str, os.PathLike, Mapping[str, Any]]

_log = logging.getLogger("ricochet")


class RicochetError(RuntimeError):
    """The program ended with an error. Its text is what the program wrote on standard error.

    status  exit status: 2 the scene or an argument is wrong, 3 the solve failed, 4 a file could not be read or written, 130 the run was
            interrupted; negative: the signal that ended the program
    """

    def __init__(self, message: str, status: int):
        super().__init__(message, status)
        self.status = status

    def __str__(self) -> str:
        return self.args[0]


def run(
    scene: Scene,
    output: Optional[Union[str, os.PathLike]] = None,
    *,
    set: Mapping[str, Any] = {},
    ranks: Optional[int] = None,
    program: Union[str, os.PathLike] = "ricochet",
    petsc: Sequence[Any] = (),
) -> Run:
    """Computes a scene and returns its result. All values are in SI units, as in the scene.

    scene    path of a scene (.toml) or of a result (.h5), whose scene is computed again; or a dict; or a text of TOML, which is told from a
             path by its line breaks. In a dict or a text, the path of a mesh is relative to the current folder
    output   path of the result. Without it the result is kept in memory alone, and fields (`output.fields`) are lost
    set      values that replace those of the scene, by dotted key: {"impactor.speed": 2.0, "body.model": "mindlin"}; None removes a key
    ranks    number of MPI ranks, started by mpirun; without it the program runs alone
    program  name or path of the program
    petsc    options for PETSc: ["-ksp_type", "cg"]

    Warnings of the program are logged (logger "ricochet", level WARNING), and what else it writes on standard error at level INFO.

    Raises RicochetError if the program ends with an error, and FileNotFoundError if the program or mpirun is not found.
    """
    given, text = _given(scene)
    command = [_found("mpirun"), "-n", str(ranks)] if ranks is not None else []
    command += [_found(os.fspath(program)), "run", given]
    for key, item in set.items():
        command += ["--set", f"{key}={'' if item is None else value(item)}"]
    options = ["--", *map(str, petsc)] if petsc else []
    with tempfile.TemporaryDirectory(prefix="ricochet-") as folder:
        path = os.path.join(folder, "result.h5") if output is None else os.fspath(output)
        _call([*command, f"--output={path}", *options], text)
        return Run(path)


def _given(scene: Scene) -> tuple[str, Optional[str]]:
    """The program's argument for a scene, and the text for its standard input."""
    if isinstance(scene, Mapping):
        return "-", document(scene)
    path = os.fspath(scene)
    # No scene fits on one line: TOML has one key a line.
    if isinstance(scene, str) and "\n" in scene:
        return "-", scene
    # A name such as "-" is a file's too.
    return (os.path.join(".", path) if path.startswith("-") else path), None


def _found(program: str) -> str:
    if shutil.which(program) is None:
        raise FileNotFoundError(f"the program {program} is not found: put it on PATH, or give its path (program=...)")
    return program


def _call(command: Sequence[str], text: Optional[str]) -> None:
    """Runs a command with a text on its standard input; logs what it writes on standard error, or raises it."""
    process = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL if text is None else subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        errors="replace",
    )
    with process:
        try:
            said = process.communicate(text)[1]
        except BaseException:
            # The program then ends in order and writes a checkpoint. Not SIGINT: a terminal has sent that already, and a second one makes
            # mpirun kill the ranks.
            process.send_signal(signal.SIGUSR1)
            process.communicate()
            raise
    if process.returncode:
        ended = f"ended by signal {-process.returncode}" if process.returncode < 0 else f"ended with status {process.returncode}"
        raise RicochetError(said.strip() or f"{command[0]} {ended} without a message", process.returncode)
    for line in said.splitlines():
        warning = re.match(r"(?:warning:| WARN) *(.*)", line)
        if warning:
            _log.warning(warning[1])
        else:
            _log.info(line)
