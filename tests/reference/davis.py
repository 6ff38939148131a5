"""Plain twin of the camera's decoder, word by word, with nothing kept but names."""

import numpy as np


class PlainDecoder:
    """Takes words one at a time; ``events`` are (t, x, y, on), ``frames`` (pixels, begin, end)."""

    def __init__(self, layout, synced=False):
        self.layout, self.synced = layout, synced
        self.events, self.frames = [], []
        self.count = dict.fromkeys(
            ["bad_rows", "bad_columns", "orphans", "backward", "unknown", "resets", "bad_frames"], 0
        )
        self.origin = self.base = self.now = 0
        self.row = None
        self.frame = None
        self.pixels = np.zeros((260, 346), int)
        self.reset = np.zeros((260, 346), int)
        self.high = 0

    def feed(self, data):
        assert len(data) % 2 == 0
        for k in range(0, len(data), 2):
            self.take(data[k] | data[k + 1] << 8)

    def take(self, word):
        if not self.synced:
            self.synced = word == 1
        elif word & 0x8000:
            t = self.origin + self.base + (word & 0x7FFF)
            self.count["backward"] += t <= self.now
            self.now = max(self.now, t)
        else:
            code, data = word >> 12, word & 0xFFF
            getattr(self, f"take_{code}")(data)

    def take_0(self, data):
        f = self.frame
        if data == 1:
            self.count["resets"] += 1
            self.count["bad_frames"] += f is not None
            self.frame = self.row = None
            self.origin, self.base = self.now, 0
        elif data in (8, 9):
            self.count["bad_frames"] += f is not None
            self.frame = {"begin": self.now, "roi": [], "columns": ([], []), "now": None}
        elif data == 10 and f is not None:
            self.frame = None
            self.end(f)
        elif data in (11, 12) and f is not None:
            if f["now"] is not None or (
                data == 12 and len(f["columns"][1]) >= len(f["columns"][0])
            ):
                f["broken"] = True
            column = []
            f["columns"][data - 11].append(column)
            f["now"] = data - 11
        elif data == 13 and f is not None:
            if f["now"] is None:
                f["broken"] = True
            f["now"] = None
        elif data == 14 and f is not None:
            f["exposure_begin"] = self.now
        elif data == 15 and f is not None:
            f["exposure_end"] = self.now
        elif data not in (2, 3, 4, 5, 7, 10, 11, 12, 13, 14, 15, 16, 17):
            self.count["unknown"] += 1

    def take_1(self, data):
        self.row = data if data < self.layout.rows else None
        self.count["bad_rows"] += self.row is None

    def take_2(self, data):
        self.event(data, False)

    def take_3(self, data):
        self.event(data, True)

    def take_4(self, data):
        f = self.frame
        if f is not None and f["now"] is not None and len(f["roi"]) == 4:
            f["columns"][f["now"]][-1].append(data & 0x3FF)

    def take_5(self, data):
        kind, low = data >> 8, data & 0xFF
        if kind == 1:
            self.high = low
        elif kind == 2:
            if self.frame is not None and len(self.frame["roi"]) < 4:
                self.frame["roi"].append(self.high << 8 | low)
        elif kind not in (0, 3):
            self.count["unknown"] += 1

    def take_6(self, data):
        self.count["unknown"] += data >> 10 != 0

    def take_7(self, data):
        self.base += data * 0x8000
        self.count["backward"] += self.origin + self.base <= self.now
        self.now = max(self.now, self.origin + self.base)

    def event(self, column, on):
        if column >= self.layout.columns:
            self.count["bad_columns"] += 1
        elif self.row is None:
            self.count["orphans"] += 1
        else:
            x, y = (self.row, column) if self.layout.swap_events else (column, self.row)
            self.events.append((self.now, 345 - x if self.layout.mirrored else x, y, on))

    def end(self, f):
        """Build the picture from the columns as matrices, the chip's way round, and turn it."""
        roi = f["roi"]
        sized = len(roi) == 4 and roi[0] <= roi[2] < 346 and roi[1] <= roi[3] < 260
        if not sized or "broken" in f or f["now"] is not None:
            self.count["bad_frames"] += 1
            return
        x, y, w, h = roi[0], roi[1], roi[2] - roi[0] + 1, roi[3] - roi[1] + 1
        n_columns, n_rows = (h, w) if self.layout.swap_frames else (w, h)
        for columns in f["columns"]:
            if len(columns) != n_columns or any(len(column) != n_rows for column in columns):
                self.count["bad_frames"] += 1
                return
        reset, signal = (np.array(columns) for columns in f["columns"])
        light = np.clip(reset - signal, 0, 1023)
        light[(reset < 384) | (signal == 0)] = 1023
        light = np.minimum(255, np.ceil(light / 4))  # index [column, row]
        light = light[::-1] if self.layout.flip_columns else light
        light = light[:, ::-1] if self.layout.flip_rows else light
        picture = np.zeros((260, 346), np.uint8)
        picture[y : y + h, x : x + w] = light if self.layout.swap_frames else light.T
        if self.layout.mirrored:
            picture = picture[:, ::-1]
        end = f.get("exposure_end", self.now)
        begin = f.get("exposure_begin", -1)
        if not 0 <= begin <= end:
            begin = f["begin"]
        self.frames.append((picture, begin, end))
