"""The messages of the page to a browser as types."""

from typing import TYPE_CHECKING, Literal, NotRequired, TypedDict

from neurotouch_hid.page.output_choices import OutputGroup
from neurotouch_hid.page.own_values import OwnValuesView
from neurotouch_hid.page.profile_view import ProfileFault, ProfileView
from neurotouch_hid.page.situation import SituationKind, StartName

if TYPE_CHECKING:  # it imports numpy, which the page needs for nothing else
    from neurotouch_hid.evaluation.people.throughput import Figures


class SituationState(TypedDict):
    """A ``Situation``, ready for JSON."""

    kind: SituationKind
    text: str
    next: str
    mend: str
    start: StartName


class ProfileRow(TypedDict):
    """A profile in the list of all.

    Attributes:
        name: its name.
        own: it is the person's, not one that comes with the program.
        first: it is the first of the favourites.
        about: its description, or its first error.
        broken: it cannot be used.
    """

    name: str
    own: bool
    first: bool
    about: str
    broken: bool


class ProgramNews(TypedDict):
    """A line of output, or the end, of a program that the page has started.

    Attributes:
        name: of the program.
        line: of its output.
        code: its exit code, once it has ended.
    """

    name: str
    line: NotRequired[str]
    code: NotRequired[int]


class Remote(TypedDict):
    """The link that lets another device in.

    Attributes:
        link: the link, which contains the token.
        code: the link as the address of a picture.
        minutes: how long it may be used.
    """

    link: str
    code: str
    minutes: float


class PageMessage(TypedDict, total=False):
    """A message to a browser beside the states; each has some of these keys.

    Attributes:
        hello: the browser may stay.
        edit: the browser may change profiles and pause the driver; comes with ``hello``.
        far: the page is served to other machines; comes with ``hello``.
        driver: a driver runs.
        about: the active profile; while no driver runs, the one it would play.
        own: the person's own values, as far as the page changes them.
        saved: a sentence about what has been done; empty where the next state says it.
        refused: the reason why something has not been done.
        throughput: the figures of a game.
        situation: the reason why the gel does not play while no driver runs.
        plugged: the driver that can be started with a camera, while a simulated gel plays.
        outputs: the outputs that a movement can have.
        profiles: those there are.
        shown: a profile that the browser wants to look at.
        name: of that profile in the list.
        stop_keys: the keys that stop a driver, by what they do.
        picture: the newest frame of the camera, as the address of a picture.
        program: output or end of a program that the page has started.
        started: such a program, by name.
        stopped: the same.
        remote: the link for another device; None when its right has ended.
        n: the number of the browser's message that this answers.
    """

    hello: Literal[True]
    edit: bool
    far: bool
    driver: bool
    about: ProfileView | ProfileFault | None
    own: OwnValuesView
    saved: str
    refused: str
    throughput: "Figures"
    situation: SituationState
    plugged: StartName
    outputs: list[OutputGroup]
    profiles: list[ProfileRow]
    shown: ProfileView | ProfileFault
    name: str
    stop_keys: dict[str, str]
    picture: str
    program: ProgramNews
    started: str
    stopped: str
    remote: Remote | None
    n: int | None
