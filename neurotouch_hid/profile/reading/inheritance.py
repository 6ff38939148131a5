"""A profile built on others: what it says itself comes first, the rest is theirs."""

from neurotouch_hid.profile.schema.layering import uncovered
from neurotouch_hid.profile.schema.profile import Layer, Profile


def build_on(profile: Profile, base: Profile) -> Profile:
    """Returns the profile with what it takes from ``base``; nothing is extended any more.

    Layers of the same name become one; ``bindings`` belong to the first layer, whatever its name.
    A binding of the base stays if none of the profile's own in that layer covers it.
    """
    theirs = base.all_layers
    own = profile.all_layers
    if profile.bindings is not None and theirs:
        own = (own[0].model_copy(update={"name": theirs[0].name}), *own[1:])
    by_name = {layer.name: layer for layer in own}
    layers = [_merge(by_name.pop(layer.name, None), layer) for layer in theirs]
    layers += by_name.values()
    safety = profile.safety.model_copy(
        update={
            key: getattr(base.safety, key)
            for key in ("pause", "panic")
            if getattr(profile.safety, key) is None
        }
    )
    taken = {
        key: getattr(base, key)
        for key in ("timing", "filter", "latch")
        if getattr(profile, key) is None
    }
    return profile.model_copy(
        update={"bindings": None, "layers": layers, "safety": safety, "extends": [], **taken}
    )


def _merge(own: Layer | None, theirs: Layer) -> Layer:
    if own is None:
        return theirs
    below = own.below if "below" in own.model_fields_set else theirs.below
    bindings = [*own.bindings, *uncovered(theirs.bindings, own.bindings)]
    return own.model_copy(update={"bindings": bindings, "below": below})
