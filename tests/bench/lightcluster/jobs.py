# SPDX-License-Identifier: Apache-2.0
"""A list of measurements, run one after the other, with progress and the time that is left."""

import statistics
import time


class Jobs:
    def __init__(self, say=lambda line: print(line, flush=True), clock=time.monotonic):
        self.jobs, self.say, self.clock = [], say, clock

    def add(self, kind, text, work):
        """`work` is called without arguments; jobs of one `kind` are taken to last alike."""
        self.jobs.append((kind, text, work))

    def run(self):
        seconds = {}
        for number, (kind, text, work) in enumerate(self.jobs):
            self.say(f"[{number + 1}/{len(self.jobs)}] {text}{left([k for k, _, _ in self.jobs[number:]], seconds)}")
            start = self.clock()
            work()
            seconds.setdefault(kind, []).append(self.clock() - start)


def left(kinds, seconds):
    """', about 5 min left', or nothing before anything was measured. A kind not yet seen is taken to last as the others do."""
    if not seconds:
        return ""
    means = {kind: statistics.mean(values) for kind, values in seconds.items()}
    usual = statistics.median(means.values())
    total = sum(means.get(kind, usual) for kind in kinds)
    return f" (about {total / 60:.0f} min left)" if total >= 60 else f" (about {total:.0f} s left)"
