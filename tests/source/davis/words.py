"""Words of the camera's stream, as the public facts about it have them."""

V1 = (
    "83E8 100A 3014 2015 1159 3103 83EF 1000 2000 7001 1001 3001 8005 1002 2002 7003 FFFF 1003 3003"
)
V1_EVENTS = [
    (1000, 10, 20, True),
    (1000, 10, 21, False),
    (1000, 345, 259, True),
    (1007, 0, 0, False),
    (32768, 1, 1, True),
    (32773, 2, 2, False),
    (163839, 3, 3, True),
]

V2 = (
    "83E8 1190 3005 83E9 100A 312C 3005 83EA 2007 7003 8005 1001 3001 0000 0020 5F00 6C00 "
    "CE20 1003 3003 CA38 1004 3004 0001 8032 1002 3002 803C 1005 3005"
)
V2_EVENTS = [
    (1001, 10, 5, True),
    (1002, 10, 7, False),
    (98309, 1, 1, True),
    (118304, 3, 3, True),
    (118304, 4, 4, True),
    # The clock begins anew; ours goes on.
    (118304 + 50, 2, 2, True),
    (118304 + 60, 5, 5, True),
]

V4 = "83E8 0005 53E5 5020" + 13 * " 5000" + " 0007"


def pack(text):
    """Words in hex as the bytes that USB carries."""
    return b"".join(int(word, 16).to_bytes(2, "little") for word in text.split())


def make_frame(
    roi=(100, 50, 107, 53), reset=800, signal=None, times=(1000, 1010, 1020, 1030), begin="0008"
):
    """A global shutter frame, as V3: its difference is 8c + r in column c, row r of the chip."""
    x, y, x_end, y_end = roi
    w, h = x_end - x + 1, y_end - y + 1
    words = [f"{0x8000 | times[0]:04X}", begin, "6280", "624E", "6000"]
    for limit in roi:
        words += [f"51{limit >> 8:02X}", f"52{limit & 255:02X}"]
    for _ in range(h):
        words += ["000B", *[f"{0x4000 | reset:04X}"] * w, "000D"]
    words += [f"{0x8000 | times[1]:04X}", "000E", f"{0x8000 | times[2]:04X}", "000F"]
    for c in range(h):
        values = [800 - w * c - r if signal is None else signal for r in range(w)]
        words += ["000C", *[f"{0x4000 | value:04X}" for value in values], "000D"]
    return " ".join([*words, f"{0x8000 | times[3]:04X}", "000A"])


V3 = make_frame()
