# SPDX-License-Identifier: Apache-2.0
"""Runs the program once a try, judges its end and prints a line for each."""
import os
import re
import resource
import shlex
import signal
import subprocess

NOBODY = 65534
# What no user should read: names of C++, and errors without a place or a remedy.
NEVER = re.compile(r"filesystem error|std::|what\(\)|terminate called|bad_alloc|[.]partial-|"
                   r"\bSIG[A-Z]+\b")
ERROR = re.compile(r"^strata( [a-z]+)?: error: .+: .+; .+$")
PATIENCE_S = 120  # of a hang; nothing here takes seconds


MEMORY = 6 << 30  # of a try that takes it all: others work on this machine


def begin(user):
    """In the new process. As nobody for what the system refuses: root may read and write all."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    if user and os.getuid() == 0:
        os.setgid(NOBODY)
        os.setuid(NOBODY)


class Tries:
    def __init__(self, strata):
        self.strata = strata
        self.count = 0
        self.failed = []
        self.whole = "STRATA_EVERY_TRY" in os.environ

    def is_due(self, i, j):
        """Of a table of tries (row i, column j) a third is run, so that every row and column has its
        share; with STRATA_EVERY_TRY set, all are."""
        return self.whole or (i + j) % 3 == 0

    def judge(self, name, faults, told):
        self.count += 1
        print(("FAIL " if faults else "ok   ") + name + ": " + told, flush=True)
        for fault in faults:
            print("     " + fault, flush=True)
        if faults:
            self.failed.append(name)

    def strata_try(self, name, arguments, code, line="", shell=None, user=None, cwd=None,
                   or_fails=None, patience_s=PATIENCE_S):
        """code: the exit status, or a tuple of those allowed. line: a pattern that its output has.
        shell: a command of bash around it, with STRATA for the program and its arguments. user:
        "nobody". or_fails: it may also end with 1 and a line of this pattern. patience_s: of a
        hang."""
        codes = code if isinstance(code, tuple) else (code,)
        words = [self.strata, *arguments]
        if shell is not None:
            text = " ".join(shlex.quote(word) for word in words)
            words = ["bash", "-c", shell.replace("STRATA", text)]
        try:
            ended = subprocess.run(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, timeout=patience_s, cwd=cwd,
                                   preexec_fn=lambda: begin(user))
        except subprocess.TimeoutExpired:
            self.judge(name, ["hangs"], " ".join(arguments)[:100])
            return ""
        out = ended.stdout.decode(errors="replace")
        err = ended.stderr.decode(errors="replace")
        if or_fails is not None and ended.returncode == 1:
            codes, line = (1,), or_fails
        self.judge(name, self.faults(ended.returncode, out, err, codes, line),
                   self.told(ended.returncode, out, err))
        return out + err

    @staticmethod
    def told(code, out, err):
        last = (err.strip() or out.strip()).splitlines()[-1:]
        return f"{code} " + (last[0][:160] if last else "")

    @staticmethod
    def faults(code, out, err, codes, line):
        faults = []
        if code < 0 or code > 128:
            number = -code if code < 0 else code - 128
            faults.append("is ended by " + signal.Signals(number).name)
        if code not in codes:
            faults.append(f"exit status {code}, expected {' or '.join(map(str, codes))}")
        errors = [text for text in err.splitlines() if ": error: " in text]
        expects_error = code != 0
        if expects_error and (len(errors) != 1 or not ERROR.match(errors[0])):
            faults.append("has no line with place, problem and remedy: " + err[-300:])
        if not expects_error and errors:
            faults.append("tells of an error: " + errors[0])
        if found := NEVER.search(err):
            faults.append(f"says '{found.group()}': " + err[-300:])
        if not re.search(line, out + err):
            faults.append(f"does not say '{line}': " + (err or out)[-300:])
        return faults

    def hold(self, name, holds, told=""):
        """A claim about what the program left."""
        self.judge(name, [] if holds else ["does not hold"], told)

    def end(self):
        print(f"{self.count} tries, {len(self.failed)} failed")
        for name in self.failed:
            print("  failed: " + name)
        return 1 if self.failed or self.count == 0 else 0
