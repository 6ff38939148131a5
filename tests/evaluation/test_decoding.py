"""What the benchmark of the decoder measures."""

import numpy as np

from neurotouch_hid.evaluation.speed import decoding
from neurotouch_hid.source.davis.decoder import Decoder, DecoderStats


def test_the_stream_is_sound_and_holds_five_events_a_microsecond():
    decoder = Decoder(synced=True)
    events, frames = decoder.decode(decoding._make_stream())
    assert decoder.stats() == DecoderStats()
    assert not frames
    assert (np.bincount(events["t"])[1:] == decoding.EVENTS_PER_US).all()
    assert events["t"][-1] == decoding.N_US


def test_every_transfer_has_a_rate():
    assert (decoding.measure_decoding() > 0).all()
