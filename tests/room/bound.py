"""What a recogniser that knew the truth of every slice would reach with the labels."""

from collections.abc import Callable, Sequence

from neurotouch_hid.evaluation.accuracy.label_track import LabelTrack
from neurotouch_hid.messages import Truth

MOST_LATE = 4  # slices; labels are as far apart


def find_bound(labels: LabelTrack, slices: Sequence[Truth]) -> dict[str, float]:
    """Returns the best type and count that the labels of a recording allow.

    The label of a slice is that of the frame before it, up to 40 ms old. So even the truth does not
    reach 1, and it comes nearest if it is told some slices late.

    Args:
        labels: of the frames.
        slices: the truth at the end of each slice, at least one of them with a label.
    """
    labelled = [labels.at(truth.t_us) for truth in slices]

    def share(is_same: Callable[[Truth, Truth], bool]) -> float:
        shares = []
        for late in range(min(MOST_LATE, len(slices) - 1) + 1):
            told = zip(labelled[late:], slices, strict=False)
            right = [is_same(label, truth) for label, truth in told if label is not None]
            shares.append(sum(right) / max(len(right), 1))
        return max(shares)

    return {
        "type_bound": share(lambda label, truth: label.kind is truth.kind),
        "count_bound": share(lambda label, truth: len(label.contacts_px) == len(truth.contacts_px)),
    }
