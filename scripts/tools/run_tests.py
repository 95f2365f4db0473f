#!/usr/bin/env python3
"""Runs the tests that CTest knows of, with one process for many tests of a GoogleTest program.

    scripts/tools/run_tests.py BUILD [--jobs N] [CTEST SELECTION: -R NAME, -E NAME, -L LABEL ...]

CTest starts a process for each test; tests that share a rendered recording would render it again each time. Here the
tests of a program run in batches: whole suites, about 20 tests, one process. A test that crashes or takes longer than
its TIMEOUT fails, and the rest of its batch goes on in a new process. Other tests run by themselves, fixtures first.
End-to-end tests and those of other languages take longest and begin, so that short ones fill the end.
Tests whose label ends in `_waits` hardly compute (live sources): they run one after the other, beside the others.
Prints a line per batch, the output of failures, and at the end `N passed, N failed[, N skipped]`.
Writes BUILD/test-times.tsv: processor seconds, seconds, result and name of each test, most expensive first.
"""
import argparse
import json
import os
import queue
import re
import select
import signal
import subprocess
import sys
import threading
import time
from collections import Counter, defaultdict
from pathlib import Path

BATCH = 20  # tests; a suite stays in one batch
LONG = {"end_to_end", "python", "web"}  # labels
TICKS = os.sysconf("SC_CLK_TCK")
RESULTS = ("passed", "failed", "skipped")
EVENTS = {"       OK ": "passed", "  FAILED  ": "failed", "  SKIPPED ": "skipped"}
EVENT = re.compile(r"\[( RUN      |       OK |  FAILED  |  SKIPPED )\] (\S+?)(?:, where .*?)?(?: \((\d+) ms\))?$")


class Test:
    def __init__(self, entry):
        properties = {p["name"]: p["value"] for p in entry.get("properties", [])}
        self.name = entry["name"]
        self.command = entry.get("command", [])
        self.timeout = float(properties.get("TIMEOUT", 1500))
        labels = set(properties.get("LABELS", []))
        self.cost = float(properties.get("COST", 1 if labels & LONG else 0))
        self.folder = properties.get("WORKING_DIRECTORY")
        self.environment = dict(v.split("=", 1) for v in properties.get("ENVIRONMENT", []))
        self.setup = bool(properties.get("FIXTURES_SETUP"))
        self.disabled = bool(properties.get("DISABLED"))
        self.waits = any(label.endswith("_waits") for label in labels)
        self.skip_status = properties.get("SKIP_RETURN_CODE")
        self.skip_words = properties.get("SKIP_REGULAR_EXPRESSION", [])
        filters = [a for a in self.command if a.startswith("--gtest_filter=")]
        self.id = filters[0].split("=", 1)[1] if filters else None  # the name GoogleTest uses
        self.result = None
        self.seconds = self.processor = 0.0


def discover(build, selection):
    text = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1", *selection], check=True,
                          capture_output=True, text=True).stdout
    return [Test(entry) for entry in json.loads(text)["tests"]]


def processor_seconds(pid):
    """Of a running process and of those of its children that have ended."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return sum(int(field) for field in fields[11:15]) / TICKS


class Process:
    """A process whose output is read line by line, until a deadline that moves."""

    running = set()

    def __init__(self, test, command):
        self.timeout = test.timeout
        self.popen = subprocess.Popen(command, cwd=test.folder, env={**os.environ, **test.environment},
                                      stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                      start_new_session=True)
        self.pid = self.popen.pid
        self.running.add(self.pid)
        self.reason = None  # why it did not end well
        self.restart_clock()

    def restart_clock(self):
        self.begun = time.monotonic()

    def seconds(self):
        return time.monotonic() - self.begun

    def lines(self):
        pipe = self.popen.stdout.fileno()
        pending = b""
        while True:
            if not select.select([pipe], [], [], max(0.0, self.timeout - self.seconds()))[0]:
                self.reason = f"it took more than {self.timeout:.0f} s"
                os.killpg(self.pid, signal.SIGKILL)
                break
            chunk = os.read(pipe, 65536)
            *lines, pending = (pending + chunk).split(b"\n")
            yield from (line.decode(errors="replace") for line in lines)
            if not chunk:
                break
        if pending:
            yield pending.decode(errors="replace")

    def wait(self):
        """Its processor seconds."""
        _, status, usage = os.wait4(self.pid, 0)
        self.running.discard(self.pid)
        self.popen.stdout.close()
        self.popen.returncode = self.status = os.waitstatus_to_exitcode(status)
        if self.status != 0 and self.reason is None:
            self.reason = f"it ended with status {self.status}"
        return usage.ru_utime + usage.ru_stime


class Runner:
    def __init__(self, jobs):
        self.jobs = jobs
        self.lock = threading.Lock()
        self.failed = []

    def say(self, text):
        with self.lock:
            print(text, flush=True)

    def finish(self, test, result, output, reason=""):
        test.result = result
        if result == "failed":
            with self.lock:
                self.failed.append(test.name)
                print("\n".join([f"--- {test.name}: FAILED", *output, *([reason] if reason else []), "---"]), flush=True)

    def run_alone(self, test):
        if test.disabled:
            return self.finish(test, "skipped", [])
        if not test.command or not os.access(test.command[0], os.X_OK):
            return self.finish(test, "failed", [], "its program was not built")
        process = Process(test, test.command)
        output = list(process.lines())
        test.seconds = process.seconds()
        test.processor = process.wait()
        text = "\n".join(output)
        if (test.skip_status is not None and process.status == int(test.skip_status)) or any(
                re.search(words, text, re.M) for words in test.skip_words):
            self.finish(test, "skipped", output)
        else:
            self.finish(test, "failed" if process.reason else "passed", output, process.reason)
        self.say(f"{test.name}: {test.result}, {test.seconds:.1f} s")

    def run_batch(self, tests):
        start = time.monotonic()
        left = tests
        while left:
            self.run_process(left)
            left = [test for test in left if test.result is None]
        count = Counter(test.result for test in tests)
        said = ", ".join(f"{count[result]} {result}" for result in RESULTS if count[result])
        suites = list(dict.fromkeys(suite_of(test) for test in tests))
        more = f" and {len(suites) - 1} more" if len(suites) > 1 else ""
        self.say(f"{Path(tests[0].command[0]).name} {suites[0]}{more}: {said}, {time.monotonic() - start:.1f} s")

    def run_process(self, tests):
        """Runs tests of one program until it ends, crashes or hangs. At least one of them has a result then."""
        waiting = {test.id: test for test in tests}
        process = Process(tests[0], [tests[0].command[0], "--gtest_color=no", f"--gtest_filter={':'.join(waiting)}"])
        current, output, used = None, [], 0.0
        for line in process.lines():
            event = EVENT.search(line)
            test = waiting.get(event[2]) if event else None
            if test is not None and event[1] == " RUN      ":
                current, output = test, []
                process.restart_clock()
                used = processor_seconds(process.pid)
            elif test is not None and test is current and event[3]:
                now = processor_seconds(process.pid)
                test.processor = now - used
                test.seconds = int(event[3]) / 1000
                self.finish(test, EVENTS[event[1]], [*output, line])
                current, output, used = None, [], now
                process.restart_clock()
            else:
                output.append(line)
        process.wait()
        ended = [test for test in tests if test.result]
        if current is not None:
            current.seconds = process.seconds()
            self.finish(current, "failed", output, process.reason or "it did not end")
        elif process.reason and not any(test.result == "failed" for test in ended):
            # All tests passed but the process did not end well: a leak, or a crash after the last test.
            self.finish((ended or tests)[-1], "failed", output, f"after the last test of the program: {process.reason}")
        elif not ended:
            self.finish(tests[0], "failed", output, "it was not run")


def suite_of(test):
    return test.id.split(".")[0]


def batches_of(tests):
    """Of the tests of one program: whole suites, in order."""
    suites = defaultdict(list)
    for test in tests:
        suites[suite_of(test)].append(test)
    batch = []
    for suite in suites.values():
        if batch and len(batch) + len(suite) > BATCH:
            yield batch
            batch = []
        batch.extend(suite)
    if batch:
        yield batch


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1].strip())
    parser.add_argument("build")
    parser.add_argument("--jobs", type=int, default=int(os.environ.get("ALIDADE_TEST_JOBS", "2")))
    arguments, selection = parser.parse_known_args()
    tests = discover(arguments.build, selection)
    if not tests:
        print("no such test", file=sys.stderr)
        return 2

    runner = Runner(arguments.jobs)
    programs = defaultdict(list)
    work, waiting = [], []  # (cost, job)
    for test in tests:
        if test.setup:
            runner.run_alone(test)
        elif test.id and not test.disabled:
            programs[test.command[0]].append(test)
        else:
            work.append((test.cost, lambda test=test: runner.run_alone(test)))
    for of_program in programs.values():
        for batch in batches_of(of_program):
            jobs = waiting if batch[0].waits else work
            jobs.append((max(test.cost for test in batch), lambda batch=batch: runner.run_batch(batch)))

    def queue_of(jobs):
        todo = queue.SimpleQueue()
        for _, job in sorted(jobs, key=lambda entry: -entry[0]):  # the expensive ones first
            todo.put(job)
        return todo

    def worker(todo):
        while True:
            try:
                todo.get_nowait()()
            except queue.Empty:
                return

    queues = [queue_of(work)] * runner.jobs + [queue_of(waiting)]
    threads = [threading.Thread(target=worker, args=(todo,), daemon=True) for todo in queues]
    try:
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    except KeyboardInterrupt:
        for pid in list(Process.running):
            os.killpg(pid, signal.SIGKILL)
        return 130

    by_cost = sorted(tests, key=lambda test: -test.processor)
    Path(arguments.build, "test-times.tsv").write_text("".join(
        f"{test.processor:.2f}\t{test.seconds:.2f}\t{test.result}\t{test.name}\n" for test in by_cost))
    count = Counter(test.result for test in tests)
    if runner.failed:
        print("failed:\n" + "\n".join(f"  {name}" for name in sorted(runner.failed)))
    skipped = f", {count['skipped']} skipped" if count["skipped"] else ""
    print(f"{count['passed']} passed, {count['failed']} failed{skipped}")
    return 1 if count["failed"] else 0


if __name__ == "__main__":
    sys.exit(main())
