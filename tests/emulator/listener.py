"""A host as plain as can be: decodes word by word, straight from the public facts."""

from dataclasses import dataclass, field

import numpy as np


@dataclass
class Listener:
    """What a host hears.

    Attributes:
        orientation: register 2:2 (and 1:2, of which only the swap matters to events).
        strict: raise on whatever a healthy camera never sends.
    """

    orientation: int = 4
    strict: bool = True
    base: int = 0
    t: int = 0
    row: int | None = None
    events: list = field(default_factory=list)
    frames: list = field(default_factory=list)
    resets: int = 0
    wraps: list = field(default_factory=list)
    imu: list = field(default_factory=list)
    frame: dict | None = None
    fresh: bool = False

    def hear(self, data):
        assert len(data) % 2 == 0
        for word in np.frombuffer(data, "<u2").tolist():
            if word & 0x8000:
                self.time(word & 0x7FFF)
            else:
                self.code(word >> 12, word & 0xFFF)
        return self

    def time(self, low):
        if self.strict:
            assert low != 0, "a wrap or a reset says so"
            assert self.base + low > self.t, "only on change, never back"
        self.t = self.base + low

    def code(self, code, data):
        match code:
            case 0:
                self.special(data)
            case 1:
                self.row = data
                self.fresh = True
            case 2 | 3:
                x, y = (self.row, data) if self.orientation & 4 else (data, self.row)
                self.events.append((self.t, x, y, code == 3))
                self.fresh = False
            case 4:
                self.frame["columns"][-1].append(data)
            case 5:
                self.byte(data >> 8, data & 0xFF)
            case 6:
                self.frame["exposure"].append(data)
            case 7:
                assert data >= 1
                self.wraps.append(data)
                self.base += data << 15
                self.t = self.base
        if code in {1, 7} or not self.strict:
            return
        assert not self.fresh or code in (0, 4, 5, 6), "a row without an event"

    def byte(self, kind, value):
        match kind:
            case 0 | 3:
                self.imu[-1]["bytes"].append(value)
            case 1:
                self.frame["roi"].append(value << 8)
            case 2:
                self.frame["roi"][-1] |= value

    def special(self, data):
        match data:
            case 1:
                self.base = self.t = 0
                self.row = None
                self.resets += 1
            case 5:
                self.imu.append({"t": self.t, "bytes": []})
            case 8 | 9:
                self.frame = {
                    "global": data == 8,
                    "begin": self.t,
                    "exposure": [],
                    "roi": [],
                    "kinds": [],
                    "columns": [],
                }
            case 11 | 12:
                self.frame["kinds"].append(data)
                self.frame["columns"].append([])
            case 14:
                self.frame["exposure_begin"] = self.t
            case 15:
                self.frame["exposure_end"] = self.t
            case 10:
                self.frame["end"] = self.t
                if self.strict or self.complete(self.frame):
                    self.frames.append(self.finish(self.frame))

    def complete(self, frame):
        x0, y0, x1, y1 = frame["roi"]
        sizes = {len(column) for column in frame["columns"]}
        return len(frame["columns"]) == 2 * (y1 - y0 + 1) and sizes == {x1 - x0 + 1}

    def finish(self, frame):
        x0, y0, x1, y1 = frame["roi"]
        n_columns, n_rows = (
            (y1 - y0 + 1, x1 - x0 + 1) if self.orientation & 4 else (x1 - x0 + 1, y1 - y0 + 1)
        )
        picture = np.full((y1 - y0 + 1, x1 - x0 + 1), -1)
        by_kind = {
            kind: [c for k, c in zip(frame["kinds"], frame["columns"], strict=True) if k == kind]
            for kind in (11, 12)
        }
        assert len(by_kind[11]) == len(by_kind[12]) == n_columns
        for cx, (reset, signal) in enumerate(zip(by_kind[11], by_kind[12], strict=True)):
            assert len(reset) == len(signal) == n_rows
            for cy in range(n_rows):
                a = n_columns - 1 - cx if self.orientation & 2 else cx
                b = n_rows - 1 - cy if self.orientation & 1 else cy
                if self.orientation & 4:
                    a, b = b, a
                d = 1023 if reset[cy] < 384 or signal[cy] == 0 else reset[cy] - signal[cy]
                picture[b, a] = min(max(d, 0), 1023)
        low, middle, high = frame["exposure"]
        return {
            **frame,
            "picture": picture,
            "cycles": low | middle << 10 | high << 20,
        }
