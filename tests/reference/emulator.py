"""Plain twin of the emulated camera's encoder: one event after the other, words in a list."""


class PlainEncoder:
    """Keeps what the host knows, as the kernel does."""

    def __init__(self):
        self.base = self.low = 0
        self.row = None

    def put_time(self, t):
        words = []
        t = max(t, self.base + self.low)
        while t - self.base >= 0x8000:
            m = min((t - self.base) // 0x8000, 0xFFF)
            words.append(0x7000 + m)
            self.base += m * 0x8000
            self.low, self.row = 0, None
        if t - self.base != self.low:
            self.low = t - self.base
            words.append(0x8000 + self.low)
        return words

    def put_event(self, t, row, column, on):
        words = self.put_time(t)
        if self.row != (row, self.low):
            self.row = (row, self.low)
            words.append(0x1000 + row)
        words.append((0x3000 if on else 0x2000) + column)
        return words

    def encode(self, events, runs, until):
        """Words of (t, row, column, on) and (t, dated, words), both ascending, before ``until``."""
        jobs = [(t, 1, k, event) for k, event in enumerate(events) if (t := event[0]) < until]
        jobs += [(t, 0, k, run) for k, run in enumerate(runs) if (t := run[0]) < until]
        words = []
        for _, kind, _, job in sorted(jobs, key=lambda job: job[:3]):
            if kind == 1:
                words += self.put_event(*job)
            else:
                t, dated, run = job
                words += (self.put_time(t) if dated else []) + list(run)
        return words
