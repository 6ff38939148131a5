"""The stable code of every fault, and what ``neurotouch explain CODE`` says about it.

NT1xx: errors; the profile would not do what it says, so it is not loaded. NT2xx: warnings; it is
loaded, but something in it does nothing or is risky.
"""

from dataclasses import dataclass
from typing import Final

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.printable import make_printable


@dataclass(frozen=True, slots=True)
class Explanation:
    """The meaning of a code.

    Attributes:
        title: in a few words.
        text: why it matters and what to do.
    """

    title: str
    text: str


CODES: Final[dict[str, Explanation]] = {
    "NT101": Explanation(
        "not a text we can read",
        "The file is not UTF-8, or has a control character, or is empty. Save it as UTF-8 text.",
    ),
    "NT102": Explanation(
        "not YAML",
        "The text breaks a rule of YAML, often by a tab, a missing space after a colon, a bracket "
        "that is not closed, or a minus that needs quotes. The caret shows where reading stopped.",
    ),
    "NT103": Explanation(
        "YAML that profiles do not use",
        "Anchors, aliases, tags, directives, a second document, keys that are no words, very deep "
        "nesting and very many values are refused: a profile never needs them, and harmful files "
        "are made of them.",
    ),
    "NT104": Explanation(
        "a key is there twice",
        "Only one of them could apply. Remove or rename one.",
    ),
    "NT105": Explanation(
        "a value is missing",
        "A key without a value. Write one, or remove the key to get its default.",
    ),
    "NT110": Explanation(
        "an unknown key",
        "No such key exists at this place; the message lists those that do. Often it is a slip of "
        "the finger, or the key belongs one level higher or lower: check the indentation.",
    ),
    "NT111": Explanation("a key is missing", "This part cannot do without it. Add it."),
    "NT112": Explanation(
        "not one of the known words",
        "At this place only certain words mean something. The message lists them all: write one "
        "of them, in the same spelling. 'neurotouch schema' prints the words of every key.",
    ),
    "NT113": Explanation(
        "a value of another kind",
        "For example a word where a number belongs. In YAML 1.2 only true and false are truth "
        "values; yes, no, on and off are words.",
    ),
    "NT114": Explanation(
        "a number beyond what makes sense",
        "Limits come from the gel (it moves 18 mm at most), from what the sensor can tell apart, "
        "and from what people need (times up to 10 s and more).",
    ),
    "NT115": Explanation("not a finite number", "Infinity and NaN are no values for a profile."),
    "NT116": Explanation(
        "too long or too short", "A list or a text has too many or too few parts."
    ),
    "NT117": Explanation(
        "needs exactly one of several",
        "A binding does exactly one thing, and a curve has exactly one form. For two things on one "
        "gesture, write two bindings.",
    ),
    "NT118": Explanation(
        "not a name",
        "Names are 1 to 64 small letters, digits, _ or -, and - is not the first. They are never "
        "paths, so that a profile "
        "can only be built on profiles you have installed.",
    ),
    "NT119": Explanation(
        "another version",
        "The file was written for another version of the format. 'neurotouch profile upgrade' "
        "rewrites an older one; for a newer one, update the program.",
    ),
    "NT120": Explanation(
        "a character that cannot be seen",
        "Control and format characters can hide or change what a terminal shows. A description "
        "needs none of them: delete and retype it, without what was copied along.",
    ),
    "NT121": Explanation(
        "a direction without a push",
        "Only a push has a direction; pinch, zoom and twist happen in place.",
    ),
    "NT122": Explanation(
        "thresholds the wrong way round",
        "off_mm must be below on_mm. Between them nothing changes; without that gap a trembling "
        "hand would press again and again.",
    ),
    "NT123": Explanation(
        "a range without room",
        "Between rest and full the output rises. If they are too close, it jumps.",
    ),
    "NT124": Explanation(
        "a stick or pointer without a push",
        "A whole stick, the pointer, push_x and push_y follow the direction of a push. Other "
        "gestures have none; let them move one axis.",
    ),
    "NT125": Explanation(
        "a time for what follows",
        "Presses, accept times and modes belong to what is either pressed or not. A stick, an axis "
        "or the wheel follows the gesture at every moment. 'value: 1.0' makes an axis or a trigger "
        "something that is pressed.",
    ),
    "NT126": Explanation(
        "keys that do not go together", "The message says which other key this one needs."
    ),
    "NT127": Explanation(
        "not the name of a key",
        "Keys are called by what is printed on a US keyboard: a, 7, f5, enter, escape, page_up, "
        "left, volume_up. Join them with + for a chord: ctrl+shift+c.",
    ),
    "NT130": Explanation(
        "it is built on a profile that does not exist",
        "'extends' names installed profiles: your own or those shipped. It never takes a path.",
    ),
    "NT131": Explanation(
        "profiles built on each other in a circle",
        "A profile cannot, over any number of steps, be built on itself. A profile of your own "
        "takes the place of a shipped one of its name; to build on that one, give yours another "
        "name.",
    ),
    "NT132": Explanation(
        "the profile it is built on is wrong", "Check that profile first; this one needs it."
    ),
    "NT133": Explanation(
        "an unknown layer", "'layer' names a layer of this profile or of one it is built on."
    ),
    "NT134": Explanation(
        "a layer without a way back",
        "Every layer needs a way back to the first one, by gestures that work in it. "
        "Add a binding with 'layer:', or let the layer inherit the one that led there.",
    ),
    "NT135": Explanation("two layers of one name", "A binding could not tell them apart."),
    "NT136": Explanation(
        "too many layers or bindings",
        "With what it is built on, a profile has at most 8 layers and 256 bindings a layer.",
    ),
    "NT201": Explanation(
        "fingers counted too early",
        "The number of fingers is right in 90 % of cases only from 7 mm on, and most gestures stay "
        "below that. Raise on_mm to 7, or tell the actions apart by something else.",
    ),
    "NT202": Explanation(
        "thresholds closer than the noise",
        "The intensity is wrong by 0.96 mm on average. With less than that between on_mm and "
        "off_mm, a steady hand presses by chance.",
    ),
    "NT203": Explanation(
        "a double tap that delays the tap",
        "If a gesture has a tap and a double tap, the tap must wait to see whether a second one "
        "follows. The message says how long. A hold instead of the double tap costs nothing.",
    ),
    "NT204": Explanation(
        "a binding that never acts",
        "Another binding of the same layer does the same, or its range is beyond what people "
        "reach with this gesture.",
    ),
    "NT205": Explanation(
        "a very long hold",
        "Holding a gesture for more than 5 s tires. 'mode: toggle' holds it for you.",
    ),
    "NT206": Explanation(
        "a layer held by the gel",
        "The gel recognises one gesture at a time, so no other gesture acts while one holds a "
        "layer. Use 'mode: toggle' or 'mode: oneshot'.",
    ),
    "NT207": Explanation(
        "levels too close",
        "A soft and a hard level should be 3 mm apart, or one is taken for the other.",
    ),
    "NT208": Explanation(
        "a hold behind a press at once",
        "A binding without 'press' acts as soon as its gesture begins, and so also before every "
        "tap, double and hold of the same gesture. Give it 'press: tap', or a larger 'on_mm' than "
        "theirs, if that is not meant.",
    ),
    "NT209": Explanation(
        "a layer that nothing leads to",
        "No binding leads to this layer, so nothing in it ever acts.",
    ),
    "NT210": Explanation(
        "a press within the noise",
        "Below 2.5 mm the type of a gesture is often wrong, so this may press by mistake.",
    ),
    "NT211": Explanation(
        "panic and nothing else",
        "A panic gesture can be made by accident, and then only the keyboard goes on. Offer a "
        "pause gesture too.",
    ),
    "NT212": Explanation(
        "a movement you do not use",
        "Calibration, or 'unused' in user.yaml, says that you do not make this movement, so what "
        "is taken for it does nothing. Give the binding another gesture; 'neurotouch profile new' "
        "does that for a whole template. If you do make it: neurotouch calibrate GESTURE.",
    ),
    "NT213": Explanation(
        "a key that Linux takes for itself",
        "Alt+Print begins an order to the kernel (SysRq): the key after it could restart the "
        "machine. The keyboard we make leaves Print out while Alt is down, so only Alt is pressed.",
    ),
    "NT214": Explanation(
        "another name than the file",
        "A profile is called by the name of its file, in every command. 'name' in the file says "
        "something else. Write the file's name there, or rename the file.",
    ),
}


def explain(code: str) -> Explanation:
    """Returns the meaning of a code.

    Raises:
        ProfileError: there is no such code.
    """
    known = CODES.get(code.upper())
    if known is None:
        digits = "".join(filter(str.isdecimal, code))  # the number alone, or a slip in the letters
        meant = f"NT{digits}"
        raise ProfileError(
            f"No fault has the code '{make_printable(code[:16])}'.",
            hint=f"Did you mean '{meant}'?" if meant in CODES else "List them: neurotouch explain",
        )
    return known
