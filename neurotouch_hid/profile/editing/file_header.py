"""Changes the header of a profile: its schema line, its version and its name."""

from typing import Final

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.profile.editing.profile_text import ProfileText

VERSION: Final = 1
MODELINE: Final = "# yaml-language-server: $schema="


def adopt(text: ProfileText, name: str, schema: str) -> ProfileText:
    """Returns the text for another folder, with its ``name`` and schema line corrected.

    Args:
        text: the profile.
        name: what it is to be called.
        schema: the path of the schema, as seen from its new folder.
    """
    first, newline, rest = text.text.partition("\n")
    if first.startswith(MODELINE):
        end = "\r" if first.endswith("\r") else ""
        text = text.rewrite(f"{MODELINE}{schema}{end}{newline}{rest}")
    document = text.document
    if isinstance(document, dict) and "name" in document and document["name"] != name:
        return text.replace(("name",), name)
    return text


def forget_schema(text: ProfileText) -> ProfileText:
    """Returns the text without a path of this machine in its schema line."""
    first, newline, rest = text.text.partition("\n")
    if not first.startswith(MODELINE):
        return text
    name = first.removeprefix(MODELINE).strip().rsplit("/", 1)[-1]
    return text.rewrite(f"{MODELINE}{name}{newline}{rest}")


def upgrade(text: ProfileText, schema: str) -> ProfileText:
    """Returns the text in the current version of the format, with a schema line for editors.

    Raises:
        ProfileError: it is of a version we do not know.
    """
    document = text.document
    if not isinstance(document, dict):
        raise ProfileError("The file is not a profile.")
    version = document.get("version", 0)
    if version not in range(VERSION + 1):
        raise ProfileError(
            f"The file is of version {version}, this program knows {VERSION}.",
            hint="Update the program.",
        )
    if version == 0:  # files from before there were versions
        text = text.remove(("version",)) if "version" in document else text
        begin = text.layout.begin
        text = text.rewrite(f"{text.text[:begin]}version: {VERSION}\n{text.text[begin:]}")
    if MODELINE not in text.text:
        text = text.rewrite(f"{MODELINE}{schema}\n{text}")
    return text
