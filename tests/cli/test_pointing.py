"""``neurotouch bench pointing`` from end to end, without a person."""

import json

from click.testing import CliRunner

from neurotouch_hid.cli.bench import command


def bench(*arguments):
    return CliRunner().invoke(command, [str(argument) for argument in arguments])


def test_a_simulated_test_is_labelled_saved_and_compared(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    path = tmp_path / "before.json"
    first = bench("pointing", "--simulated", "--json", path)
    assert first.exit_code == 0, first.output
    lines = first.output.splitlines()
    assert lines[0].startswith("SIMULATED")
    assert any(line.startswith("throughput (SIMULATED): ") for line in lines)
    result = json.loads(path.read_text())
    assert (result["simulated"], result["trials"], len(result["blocks"])) == (True, 18, 2)
    again = bench("pointing", "--simulated", "--compare", path)
    assert again.output.count("the same") == 3, "the subject is deterministic"
    other = bench("pointing", "--simulated", "--compare", path, "--profile", "mouse")
    assert "SIMULATED movement time: before" in other.output
    assert ", worse" in other.output


def test_a_simulated_subject_presses_no_button():
    done = bench("pointing", "--simulated", "--select", "button")
    assert done.exit_code == 2
    assert "dwell only" in done.output


def test_bench_alone_keeps_its_options():
    assert "--json" in bench("--help").output
    assert "--method" in bench("--help").output
    assert {option.name for option in command.params} == {"method", "json_path", "long"}
    assert command.invoke_without_command
