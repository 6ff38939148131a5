"""The layers of a profile at work: one of them holds at a time."""

from typing import Final

from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile.decision import Journal
from neurotouch_hid.profile.diagnostics.description import describe_binding
from neurotouch_hid.profile.engine.binding_runner import BindingRunner
from neurotouch_hid.profile.engine.conditioned import ConditionedGesture
from neurotouch_hid.profile.engine.output import Outputs
from neurotouch_hid.profile.engine.pointer import PointerCare
from neurotouch_hid.profile.schema.layering import merge_bindings
from neurotouch_hid.profile.schema.profile import Binding, Profile
from neurotouch_hid.profile.schema.targets import CommandTarget, LayerTarget, MouseMotionTarget
from neurotouch_hid.profile.schema.timing import Times

_NONE: Final[frozenset[BindingRunner]] = frozenset()

STOPPING: Final = ("pause", "panic")
"""The commands that are heard even while everything is paused."""


class LayerStack:
    """All channels of a profile, layer by layer.

    Attributes:
        kinds: every gesture that any binding waits for.
        armed: the current gesture may act; false after a change until it has ended.
    """

    def __init__(self, profile: Profile, times: Times, journal: Journal) -> None:
        layers = profile.all_layers
        self._names = [layer.name for layer in layers]
        self._layers = [
            _Layer(merge_bindings(layer, layers[0]), times, journal) for layer in layers
        ]
        self._journal = journal
        self._current = 0
        self._holder: BindingRunner | None = None
        self._for_one_action = False
        self.armed = True
        self.kinds = frozenset(
            kind for layer in self._layers for channel in layer.channels for kind in channel.kinds
        )

    @property
    def name(self) -> str:
        """The name of the layer that holds."""
        return self._names[self._current]

    def release(self) -> None:
        """Releases everything, back to the first layer."""
        self._enter(0)

    def run(self, reading: ConditionedGesture, commands: list[str]) -> Outputs:
        """What the bindings put out; commands they give are added to ``commands``."""
        if self._holder is not None:
            self._holder.update(reading)
            if not self._holder.down:
                return self._go(0)
        if not self.armed:
            reading = ConditionedGesture(reading.t_us)
        layer = self._layers[self._current]
        outputs = Outputs()
        pressed, finished = [], False
        wanted, silent = layer.find_wanted(reading), layer.find_silent(reading)
        for channel in layer.channels:
            if not channel.busy and channel not in wanted:
                continue
            before = channel.down
            if channel in silent:
                channel.withdraw(reading.t_us)
            else:
                channel.update(reading)
                if channel.down != before and not channel.binding.is_followed:
                    if channel.down:
                        pressed.append(channel)
                    elif channel.binding.mode not in ("sticky", "oneshot"):
                        finished = True
            if channel.down and channel.put is not None:
                channel.put(outputs, reading)
        if finished:
            self._finish_action(layer)
        for care in layer.cares:
            care.tend(outputs, reading.t_us)
        for channel in pressed:
            self._journal.note("pressed", channel.label)
            if isinstance(channel.binding.do, CommandTarget):
                commands.append(channel.binding.do.command)
            elif isinstance(channel.binding.do, LayerTarget):
                return self._change(channel, channel.binding.do)
        if finished and self._for_one_action:
            return self._go(0)
        return outputs

    def listen(self, reading: ConditionedGesture, commands: list[str]) -> None:
        """While paused: hears only the bindings that pause or panic."""
        if not self.armed:
            return
        for channel in self._layers[self._current].stopping:
            before = channel.down
            channel.update(reading)
            if channel.down and not before and isinstance(channel.binding.do, CommandTarget):
                commands.append(channel.binding.do.command)

    def _finish_action(self, layer: "_Layer") -> None:
        for channel in layer.channels:
            channel.finish_action()

    def _change(self, channel: BindingRunner, target: LayerTarget) -> Outputs:
        wanted = self._names.index(target.layer) if target.layer in self._names else 0
        if wanted == self._current:
            return self._go(0)
        outputs = self._go(wanted, channel if target.mode == "hold" else None)
        self._for_one_action = target.mode == "oneshot"
        return outputs

    def _go(self, index: int, holder: BindingRunner | None = None) -> Outputs:
        """Enters a layer: nothing is put out before the next gesture."""
        self._enter(index, holder)
        self._journal.note("layer", self.name)
        return Outputs()

    def _enter(self, index: int, holder: BindingRunner | None = None) -> None:
        """Releases everything but the channel that holds the layer to come."""
        for channel in (*self._layers[self._current].channels, self._holder):
            if channel is not None and channel is not holder and channel.busy:
                channel.reset()
        self._current = index
        self._holder = holder
        self._for_one_action = False
        self.armed = False


class _Layer:
    """The channels of one layer, and who cares for its pointer."""

    def __init__(self, bindings: tuple[Binding, ...], times: Times, journal: Journal) -> None:
        self.channels = [make_channel(binding, times, bindings, journal) for binding in bindings]
        self.stopping = [
            channel
            for channel in self.channels
            if isinstance(channel.binding.do, CommandTarget)
            and channel.binding.do.command in STOPPING
        ]
        self.cares = [
            PointerCare(binding.do, journal)
            for binding in bindings
            if isinstance(binding.do, MouseMotionTarget)
        ]
        self._journal = journal
        self._chords = [each for each in self.channels if each.binding.condition.with_button]
        plain = frozenset(self.channels).difference(self._chords, self.stopping)
        self._plain = plain
        self._pressing = frozenset(each for each in plain if not each.binding.is_followed)
        self._taken = GestureKind.NONE
        self._wanted: dict[tuple[object, ...], frozenset[BindingRunner]] = {}

    def find_wanted(self, reading: ConditionedGesture) -> frozenset[BindingRunner]:
        """The channels this gesture may set off; found once for each kind and direction."""
        key = (reading.kind, reading.four, reading.eight)
        wanted = self._wanted.get(key)
        if wanted is None:
            wanted = frozenset(channel for channel in self.channels if channel.may_act(reading))
            self._wanted[key] = wanted
        return wanted

    def find_silent(self, reading: ConditionedGesture) -> frozenset[BindingRunner]:
        """The channels that must not hear this gesture, because it is a chord's.

        A longer chord wins over a shorter one: while its button is held, the gesture is the chord's
        alone. Once the button is released, what follows the gesture goes on, but what is pressed
        waits for the next gesture, or two things released one after the other would press a third.
        What pauses or panics is always heard.
        """
        if not self._chords:
            return _NONE
        if any(chord.claims(reading) for chord in self._chords):
            if self._taken != reading.kind:
                self._taken = reading.kind
                for channel in self.channels:
                    if channel in self._pressing and channel.may_act(reading):
                        self._journal.note("ignored", channel.label, "it is a chord's")
            return self._plain
        if self._taken != reading.kind:
            self._taken = GestureKind.NONE
        return self._pressing if self._taken != GestureKind.NONE else _NONE


def make_channel(
    binding: Binding, times: Times, siblings: tuple[Binding, ...], journal: Journal
) -> BindingRunner:
    """A channel that writes into the journal what it ignored, and each step of a sequence."""
    label = describe_binding(binding)
    return BindingRunner(
        binding,
        times,
        siblings,
        lambda why: journal.note("ignored", label, why),
        lambda which: journal.note("step", label, which),
        label,
    )
