"""How long a page keeps its main thread to itself: by the processor's time, because the clock's hangs on what else the
machine does."""
import bisect
import os
import threading
import time

INTERVAL = 0.01  # s between samples


def renderers(parent):
    """The renderers among the processes below one."""
    children = {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat", encoding="utf-8", errors="replace") as file:
                children.setdefault(int(file.read().rpartition(")")[2].split()[1]), []).append(int(name))
        except OSError:
            pass
    found, below = [], [parent]
    while below:
        process = below.pop()
        below += children.get(process, [])
        try:
            with open(f"/proc/{process}/cmdline", encoding="utf-8", errors="replace") as file:
                found += [process] if "--type=renderer" in file.read() else []
        except OSError:
            pass
    return found


class Tasks:
    """Between `with` and its end: longest() gives the most processor time of one task, in ms."""

    def __init__(self, browser):
        self.browser = browser
        self.samples = {process: [] for process in renderers(browser.driver.pid)}  # (s since 1970, ns of the main thread)
        self.thread = threading.Thread(target=self.sample, daemon=True)
        self.ended = False

    def sample(self):
        while not self.ended:
            for process, samples in self.samples.items():
                try:
                    with open(f"/proc/{process}/task/{process}/schedstat", encoding="utf-8") as file:
                        samples.append((time.time(), int(file.read().split()[0])))
                except OSError:
                    pass
            time.sleep(INTERVAL)

    def __enter__(self):
        self.browser.run("window.tasks = []; window.watching = new PerformanceObserver((list) => list.getEntries().forEach("
                         "(e) => window.tasks.push([performance.timeOrigin + e.startTime, e.duration])));"
                         "window.watching.observe({ entryTypes: ['longtask'] })")
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.ended = True
        self.thread.join()
        self.tasks = self.browser.run("return window.tasks")

    def spent(self, samples, begin, end):
        times = [at for at, _ in samples]
        first = max(0, bisect.bisect_right(times, begin) - 1)
        last = min(len(samples) - 1, bisect.bisect_left(times, end))
        return (samples[last][1] - samples[first][1]) / 1e6

    def longest(self):
        return max((min(duration, max((self.spent(samples, begin / 1000, (begin + duration) / 1000)
                                       for samples in self.samples.values() if samples), default=duration))
                    for begin, duration in self.tasks), default=0)
