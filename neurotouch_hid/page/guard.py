"""Access rules of the page's server: host, origin, token, and limits on browsers and messages."""

import hashlib
import hmac
import ipaddress
import re
import secrets
import time
from collections import Counter
from typing import Final, Protocol, cast

from neurotouch_hid.errors import PageError

MOST_BROWSERS: Final = 4
"""Those who have shown the token. Nobody else can take these places."""

MOST_WAITING: Final = 256
"""Connections that have not shown the token yet, or fetch a file. Beyond it the oldest one goes."""

MOST_BYTES: Final = 8 * 1024
"""The longest message a browser sends."""

MESSAGES_PER_S: Final = 250.0
"""A mouse reports 125 times a second, a very quick one 1000, which the page thins out."""

TOKEN_S: Final = 5.0
"""Time within which a browser must send its token."""

TICKET_S: Final = 60.0
"""Time for which a ticket opens the page: a browser may have to start first."""

SILENCE_S: Final = 20.0
"""Interval of pings to a browser; without an answer, it is dropped after twice this time."""

LEAST_TOKEN: Final = 22
"""Characters of 64 kinds: 132 bits."""

HEADERS: Final = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
        "img-src 'self' data:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-store",
}
"""Headers of every answer. There is no CORS header, so that other sites cannot read anything."""

LOCAL: Final = ("localhost", "127.0.0.1", "[::1]")


def make_token() -> str:
    """Returns a new secret."""
    return secrets.token_urlsafe(24)


def make_ticket(token: str) -> str:
    """Returns what opens the page once more within a minute, without saying the token.

    Every user of the machine can read the arguments of a browser that is started, so the token must
    not be one of them. A ticket helps only who has it and is the owner, see ``Server``.
    """
    return _sign(token.encode(), int(time.monotonic() + TICKET_S))


def _sign(token: bytes, until_s: int) -> str:
    """Returns a ticket that ends at a moment of the machine's clock since its start."""
    return f"{until_s}-{hmac.new(token, str(until_s).encode(), hashlib.sha256).hexdigest()}"


class Guard:
    """Knows the server's names, and the secret of this run.

    Host and Origin are each compared with a list: a site that rebinds its name to this machine
    sends its own name in both, so comparing them with each other proves nothing.

    Args:
        token: the secret; every client must send it as its first message.
        address: a further address to listen at; None: only this machine.

    Raises:
        PageError: the address is not that of one interface, or the token is too weak.
    """

    def __init__(self, token: str, address: str | None = None) -> None:
        if not re.fullmatch(rf"[A-Za-z0-9_-]{{{LEAST_TOKEN},}}", token):
            raise PageError(
                f"The page needs a token of at least {LEAST_TOKEN} letters, digits, _ or -.",
                hint="Make one: head -c 24 /dev/urandom | base64 | tr +/ -_",
            )
        self._token = token.encode()
        self._names = {*LOCAL, *([] if address is None else [_write_host(address)])}
        self._ports: set[int] = set()

    def open_port(self, port: int) -> None:
        """Sets the port that the page is served at."""
        self._ports.add(port)

    @property
    def hosts(self) -> frozenset[str]:
        """The permitted values of a Host header."""
        return frozenset(f"{name}:{port}" for name in self._names for port in self._ports)

    @property
    def origins(self) -> frozenset[str]:
        """The permitted values of an Origin header."""
        return frozenset(f"http://{host}" for host in self.hosts)

    def knows(self, token: object) -> bool:
        """Returns True if it is the secret; takes as long if it is not."""
        said = token.encode("utf-8", "replace") if isinstance(token, str) else b""
        return secrets.compare_digest(said, self._token)

    def accepts(self, ticket: str) -> bool:
        """Returns True if a ticket was made with the secret and has not ended."""
        until_s, now_s = ticket.partition("-")[0], time.monotonic()
        if not re.fullmatch("[0-9]{1,12}", until_s) or not ticket.isascii():
            return False
        is_true = secrets.compare_digest(ticket, _sign(self._token, int(until_s)))
        return is_true and now_s <= int(until_s)

    def link(self, page: str) -> str:
        """Returns where a page is on this server, with the secret."""
        return f"/{page}#k={self._token.decode()}"


def _write_host(address: str) -> str:
    try:
        parsed = ipaddress.ip_address(address)
    except ValueError:
        raise PageError(
            f"'{address}' is not an IP address.",
            hint="Give the address of one interface of this machine, see: ip address",
        ) from None
    if parsed.is_unspecified or parsed.is_multicast:
        raise PageError(
            f"At the address {address}, anyone who can reach this machine could open the page.",
            hint="Give the address of one interface of this machine, see: ip address",
        )
    return f"[{parsed}]" if parsed.version == 6 else str(parsed)


class Connection(Protocol):
    """A connection that can be ended at once."""

    def drop(self) -> None:
        """Ends it."""


class Waiting:
    """The connections whose token has not been seen. None of them can keep a new one out.

    A page shows its token as soon as it is connected, so an old one is hardly the owner's. Where
    there are too many, the oldest one goes, of the address with the most.
    """

    def __init__(self, most: int = MOST_WAITING) -> None:
        self._most = most
        self._addresses: dict[Connection, str] = {}  # the oldest first

    def add(self, connection: Connection, address: str) -> None:
        """Takes one in; another one may have to go."""
        self._addresses[connection] = address
        if len(self._addresses) > self._most:
            crowd = Counter(self._addresses.values()).most_common(1)[0][0]
            oldest = next(each for each, its in self._addresses.items() if its == crowd)
            self.remove(oldest)
            oldest.drop()

    def remove(self, connection: object) -> None:
        """Forgets one that has sent the token or gone. A second call does nothing."""
        self._addresses.pop(cast(Connection, connection), None)


class Rate:
    """Limits the messages of a browser: a token bucket."""

    def __init__(self, per_s: float = MESSAGES_PER_S) -> None:
        self._per_s = per_s
        self._left = per_s
        self._at = time.monotonic()

    def allows(self) -> bool:
        """Returns False if there are too many messages."""
        now = time.monotonic()
        self._left = min(self._left + (now - self._at) * self._per_s, self._per_s)
        self._at = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
