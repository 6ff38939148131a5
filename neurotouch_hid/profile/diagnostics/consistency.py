"""Checks a whole profile: its layers exist, and each can be left again."""

from collections.abc import Iterator

from neurotouch_hid.files.faults import Fault, Keys, format_path, suggest
from neurotouch_hid.files.yaml_document import Node, find_key_mark, find_mark
from neurotouch_hid.profile.schema.layering import merge_bindings
from neurotouch_hid.profile.schema.profile import Binding, Layer, Profile
from neurotouch_hid.profile.schema.targets import LayerTarget

MAX_LAYERS = 8
MAX_BINDINGS = 256


def list_bindings(profile: Profile) -> Iterator[tuple[Keys, Layer, Binding]]:
    """Gives every binding as it is in the file, with its path and its layer."""
    own = [("bindings",), *(("layers", i, "bindings") for i in range(len(profile.layers or ())))]
    if profile.bindings is None:
        own = own[1:]
    for keys, layer in zip(own, profile.all_layers, strict=True):
        for i, binding in enumerate(layer.bindings):
            yield (*keys, i), layer, binding


def check_layers(profile: Profile, whole: Profile, root: Node) -> list[Fault]:
    """Returns the faults of the layers.

    Args:
        profile: as it is in the file.
        whole: with everything it is built on.
        root: the file.
    """
    return [
        *_find_twins(profile, root),
        *_find_unknown(profile, whole, root),
        *_find_dead_ends(profile, whole, root),
        *_find_excess(whole, root),
    ]


def _find_twins(profile: Profile, root: Node) -> Iterator[Fault]:
    names = [layer.name for layer in profile.all_layers]
    first = len(names) - len(profile.layers or ())
    for i, name in enumerate(names):
        if name in names[:i]:
            keys: Keys = ("layers", i - first, "name")
            sentence = f"there is already a layer '{name}'"
            yield Fault(find_mark(root, keys), format_path(keys), sentence, code="NT135")


def _find_unknown(profile: Profile, whole: Profile, root: Node) -> Iterator[Fault]:
    names = [layer.name for layer in whole.all_layers]
    for keys, _, binding in list_bindings(profile):
        if isinstance(binding.do, LayerTarget) and binding.do.layer not in names:
            place: Keys = (*keys, "do", "layer")
            sentence = f"there is no layer '{binding.do.layer}'; layers: {', '.join(names)}"
            hint = suggest(binding.do.layer, names)
            yield Fault(find_mark(root, place), format_path(place), sentence, hint, "NT133")


def _find_dead_ends(profile: Profile, whole: Profile, root: Node) -> Iterator[Fault]:
    layers = whole.all_layers
    ways = {layer.name: _find_ways(layer, layers) for layer in layers}
    free = {layers[0].name}
    while True:
        more = {name for name, targets in ways.items() if targets & free} - free
        if not more:
            break
        free |= more
    for layer in layers:
        if layer.name not in free:
            i = next((i for i, own in enumerate(profile.layers or ()) if own.name == layer.name), 0)
            keys: Keys = ("layers", i)
            mark = find_key_mark(root, (*keys, "name"))
            sentence = f"nothing leads back from the layer '{layer.name}'"
            hint = f"add a binding with 'layer: {layers[0].name}'"
            yield Fault(mark, format_path(keys), sentence, hint, "NT134")


def _find_ways(layer: Layer, layers: tuple[Layer, ...]) -> set[str]:
    """Returns the layers that a layer leads to.

    A held layer, and one for one action, end by themselves.
    """
    first = layers[0].name
    ways = set()
    for binding in merge_bindings(layer, layers[0]):
        if isinstance(binding.do, LayerTarget):
            ways.add(first if binding.do.layer == layer.name else binding.do.layer)
    arrivals = [
        binding.do.mode
        for other in layers
        for binding in other.bindings
        if isinstance(binding.do, LayerTarget) and binding.do.layer == layer.name
    ]
    if all(mode != "toggle" for mode in arrivals):
        ways.add(first)
    return ways


def _find_excess(whole: Profile, root: Node) -> Iterator[Fault]:
    layers = whole.all_layers
    if len(layers) > MAX_LAYERS:
        sentence = f"has {len(layers)} layers, at most {MAX_LAYERS}"
        yield Fault(root.mark, "", sentence, code="NT136")
    for layer in layers:
        if len(layer.bindings) > MAX_BINDINGS:
            sentence = f"the layer '{layer.name}' has more than {MAX_BINDINGS} bindings"
            yield Fault(root.mark, "", sentence, code="NT136")
