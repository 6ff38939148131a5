"""The package in a whole Debian: put in, looked at, renewed, taken out."""

import pytest


@pytest.fixture(scope="module")
def rights(guest):
    return guest("rights")


def test_setup_gives_the_user_at_the_seat_camera_and_pad_and_takes_them_back(guest):
    seen = guest("set_up")
    assert not any(seen["before"].values())
    assert seen["dry_run"]["code"] == 0
    assert seen["after_dry_run"] == seen["before"]
    assert seen["installed"]["code"] == 0, seen["installed"]["err"]
    assert all(seen["after"].values())
    assert seen["uninstalled"]["code"] == 0, seen["uninstalled"]["err"]
    assert not seen["in_the_end"]["/dev/uinput"]
    assert not seen["left"]


def test_apt_puts_it_in(guest):
    seen = guest("install")
    assert seen["apt"]["code"] == 0, seen["apt"]["err"]


def test_nothing_is_compiled_for_the_service_when_it_is_put_in(guest):
    assert not guest("install")["compiled"]


@pytest.mark.usefixtures("at_play")
def test_with_the_camera_in_the_pad_is_there_without_any_command(guest):
    seen = guest("install")
    assert seen["pad"].startswith("/dev/input/event")


@pytest.mark.usefixtures("at_play")
def test_the_service_runs_as_nobody_in_particular(rights):
    assert rights["show"]["User"] == "neurotouch"
    assert rights["status"]["Uid"].split()[0] != "0"
    assert rights["status"]["CapEff"] == "0000000000000000"
    assert rights["status"]["NoNewPrivs"] == "1"
    assert rights["status"]["Seccomp"] == "2"


def test_its_exposure_is_small(rights):
    assert rights["exposure"] <= 1.0


@pytest.mark.usefixtures("at_play")
def test_the_right_to_make_pads_is_nobodys_while_it_plays(rights):
    assert rights["uinput"]["mode"] == "0o600"
    assert rights["uinput"]["uid"] == 0
    assert not [line for line in rights["uinput"]["acl"] if line.startswith("user:neurotouch")]
    assert not rights["player"]["/dev/uinput"]
    assert "/dev/uinput" in rights["holds"]


@pytest.mark.usefixtures("at_play")
def test_where_systemd_hands_it_over_nobody_was_ever_lent_it(rights):
    if "OpenFile" not in rights["show"]:
        pytest.skip("OpenFile= is known from systemd 253 on")
    assert rights["show"]["OpenFile"].startswith("/dev/uinput")
    assert rights["uinput"]["acl"] == ["user::rw-", "group::---", "other::---"]


@pytest.mark.usefixtures("at_play")
def test_the_camera_is_the_services_alone(rights):
    assert rights["camera"]["mode"] == "0o660"
    assert rights["camera"]["group"] == "neurotouch"
    assert not any(rights["player"].values())


@pytest.mark.usefixtures("at_play")
def test_the_user_at_the_seat_may_read_the_pad(rights):
    assert "user:player:rw-" in rights["pad"]["acl"]


def test_nothing_went_wrong_on_the_way(rights):
    assert not rights["failed_units"]


@pytest.mark.usefixtures("at_play")
def test_it_was_started_once_and_says_what_it_does(rights):
    assert rights["show"]["NRestarts"] == "0"
    assert rights["show"]["Type"] == "notify"
    assert "davis:" in rights["show"]["StatusText"]


def test_an_upgrade_keeps_the_machine_s_values_and_profiles(guest):
    seen = guest("upgrade")
    assert seen["code"] == 0
    assert "slots: [gears]" in seen["kept"]["values"]
    assert seen["kept"]["profile"]


@pytest.mark.parametrize("which", ["older", "newer"])
def test_an_older_version_can_take_its_place_and_back(guest, which):
    seen = guest("versions")[which]
    assert seen["apt"]["code"] == 0, seen["apt"]["err"]
    assert (seen["version"] == "0.0.1") == (which == "older")
    assert seen["values"] == "version: 1\nfilter: light\n"
    assert seen["runs"]["code"] == 0, seen["runs"]


@pytest.mark.usefixtures("at_play")
def test_it_is_renewed_while_it_plays(guest):
    seen = guest("upgrade")
    assert seen["new_process"]
    assert not seen["left_pressed"]


@pytest.mark.usefixtures("at_play")
def test_after_an_upgrade_the_machine_s_values_apply_until_a_person_saves_others(guest):
    seen = guest("upgrade")
    assert seen["used"]["code"] == 0, seen["used"]["err"]
    assert "filter: light" in seen["own"]
    assert "platformer" in seen["own"]
    assert seen["machine_after"] == seen["kept"]["values"]


def test_purged_it_leaves_nothing(guest):
    seen = guest("purge")
    assert seen["apt"]["code"] == 0, seen["apt"]["err"]
    for what in ("files", "folders", "user", "units", "anywhere"):
        assert not seen[what], what
    assert not any(seen["pads"])


@pytest.mark.usefixtures("at_play")
def test_purged_it_leaves_no_right_to_the_camera_and_to_pads(guest):
    seen = guest("purge")
    assert seen["still_plugged"]
    assert not [line for line in seen["uinput"]["acl"] if line.startswith("user:neurotouch")]
    assert seen["camera"]["gid"] == 0
