"""Every command of the tree with a wrong command line: one form of answer, ours, never click's."""

import errno
import json
import re
import sys

import click
import pytest
from click.testing import CliRunner

from neurotouch_hid.cli import main as command_line
from neurotouch_hid.cli.main import cli
from neurotouch_hid.cli.stream import StreamAddress
from tests.processes import run_command

NUMBERS = (click.types.IntParamType, click.types.FloatParamType)


def walk(command, words=()):
    """Gives every command below, with the words that call it."""
    yield words, command
    if isinstance(command, click.Group):
        context = click.Context(command, info_name=" ".join(words))
        for name in command.list_commands(context):
            yield from walk(command.get_command(context, name), (*words, name))


TREE = list(walk(cli))
OPTIONS = [
    (words, param)
    for words, command in TREE
    for param in command.params
    if isinstance(param, click.Option) and param.name != "help"
]


@pytest.mark.parametrize("words", [words for words, _ in TREE])
def test_every_command_has_help_with_examples(words):
    done = CliRunner().invoke(cli, [*words, "--help"])
    assert done.exit_code == 0
    assert "Examples:" in done.output


@pytest.fixture
def answer(monkeypatch, capsys):
    """Calls the command line as a person does; returns its sentence and its way out."""
    monkeypatch.setattr(command_line, "handle_interrupts", lambda: None)

    def call(*words):
        monkeypatch.setattr(sys, "argv", ["neurotouch", *words])
        with pytest.raises(SystemExit) as ended:
            command_line.main()
        printed, said = capsys.readouterr()
        assert (ended.value.code, printed) == (2, ""), said
        lines = said.splitlines()
        assert len(lines) == 2, said
        assert re.fullmatch(r"Error: ['A-Z].*[^.]\.", lines[0]), said
        assert re.fullmatch(r"Fix: ['A-Z].*", lines[1]), said
        assert len(re.findall(r"[.?!](?= |$)", lines[0])) <= 2
        return lines[0].removeprefix("Error: "), lines[1].removeprefix("Fix: ")

    return call


def fill(words):
    """Returns values for the arguments of a command, so that only its options can be wrong."""
    (command,) = [command for each, command in TREE if each == words]
    values = []
    for param in command.params:
        if isinstance(param, click.Argument) and param.required:
            kind = param.type
            values.append(kind.choices[0] if isinstance(kind, click.Choice) else "x")
    return values


@pytest.mark.parametrize("words", [words for words, _ in TREE], ids=" ".join)
def test_unknown_option(answer, words):
    sentence, fix = answer(*words, *fill(words), "--qqqqq")
    assert sentence == "There is no option --qqqqq."
    assert fix in (
        f"See: {' '.join(('neurotouch', *words))} --help",
        "Options come after the command, as in: neurotouch demo --seconds 10",
    )


@pytest.mark.parametrize(
    ("words", "option"),
    [(words, param.opts[0]) for words, param in OPTIONS if len(param.opts[0]) > 6],
    ids=str,
)
def test_misspelt_option_gets_the_right_one(answer, words, option):
    sentence, fix = answer(*words, *fill(words), option[:-2] + option[-1])
    assert "There is no option" in sentence
    assert re.fullmatch(r"Did you mean --[a-z-]+\?", fix)


@pytest.mark.parametrize(
    ("words", "param"),
    [(w, p) for w, p in OPTIONS if isinstance(p.type, (*NUMBERS, click.Choice)) and not p.is_flag],
    ids=str,
)
def test_wrong_value_of_an_option(answer, words, param):
    option = param.opts[0]
    sentence, fix = answer(*words, *fill(words), f"{option}=qqq")
    if isinstance(param.type, click.Choice):
        assert sentence == f"Option {option} cannot be 'qqq'."
        assert fix == f"Choices: {', '.join(param.type.choices)}."
        for choice in param.type.choices:
            if len(choice) > 3:
                _, fix = answer(*words, *fill(words), option, choice[:-1])
                assert fix.startswith(f"Did you mean {choice}? ")
        return
    assert re.fullmatch(rf"Option {option} must be a (whole )?number.*, not 'qqq'\.", sentence)
    example = fix.removeprefix(f"For example: {option} ")
    param.type.convert(example, param, None)  # what is proposed can be given
    if param.type.name.endswith("range"):
        sentence, _ = answer(*words, *fill(words), option, "-1000000")
        assert ", not '-1000000" in sentence


@pytest.mark.parametrize(
    ("words", "option"),
    [(words, param.opts[0]) for words, param in OPTIONS if not param.is_flag],
    ids=str,
)
def test_option_without_its_value(answer, words, option):
    sentence, _ = answer(*words, *fill(words), option)
    assert sentence == f"Option {option} needs a value."


@pytest.mark.parametrize(
    ("words", "param"),
    [
        (w, c.params)
        for w, c in TREE
        if any(isinstance(p, click.Argument) and p.required for p in c.params)
    ],
    ids=str,
)
def test_missing_argument_gets_an_example(answer, words, param):
    sentence, fix = answer(*words)
    assert re.fullmatch(r"[A-Z]+ is missing\.", sentence)
    assert fix.startswith(("For example: neurotouch ", "See: neurotouch "))


def find_word(kind):
    """A word that an argument of this kind may be."""
    if isinstance(kind, click.Choice):
        return kind.choices[0]
    return "lsl" if isinstance(kind, StreamAddress) else "x"


@pytest.mark.parametrize(
    "words",
    [w for w, c in TREE if not isinstance(c, click.Group) and all(p.nargs == 1 for p in c.params)],
    ids=" ".join,
)
def test_one_word_too_many(answer, words):
    (command,) = [command for each, command in TREE if each == words]
    arguments = [param for param in command.params if isinstance(param, click.Argument)]
    full = [find_word(param.type) for param in arguments]
    sentence, _ = answer(*words, *full, "qqq!")
    assert sentence == "'qqq!' is one argument too many."


@pytest.mark.parametrize("words", [w for w, c in TREE if isinstance(c, click.Group)], ids=" ".join)
def test_unknown_command(answer, words):
    sentence, fix = answer(*words, "qqqqq")
    assert sentence == "There is no command 'qqqqq'."
    assert fix == f"All commands: {' '.join(('neurotouch', *words))} --help"


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("rum", "Did you mean: neurotouch run"),
        ("quit", "Did you mean: neurotouch stop"),
        ("help", "Did you mean: neurotouch --help"),
        ("version", "Did you mean: neurotouch --version"),
        ("profile lst", "Did you mean: neurotouch profile list"),
        ("run sim:tour", "Did you mean: neurotouch run --source sim:tour"),
        ("run play.aedat4", "Did you mean: neurotouch run --source play.aedat4"),
        ("run racing", "Did you mean: neurotouch run --profile racing"),
        ("demo pinch", "Did you mean: neurotouch demo --scene pinch"),
        ("run --speed=fast", "Choices: recorded, max."),
        ("run --method=papr", "Did you mean paper? Methods: neurotouch, paper."),
        ("calibrate push-left=", "Did you mean push_left? Choices: "),
        ("demo --mouse --no-page", "Leave out --no-page."),
        ("--source sim:tour run", "Options come after the command"),
        ("pause --json=1", "Write only --json"),
        ("doctor --only", "See: neurotouch doctor --help"),
        ("record .", "Give the name of a file."),
        ("profile test x --file gone.txt", "Check the name."),
        ("profile bind mine pinch button a", 'Try: neurotouch profile bind mine pinch "button a"'),
        (
            "profile bind mine push left tap key ctrl+c",
            'Try: neurotouch profile bind mine "push left tap" "key ctrl+c"',
        ),
        (
            "profile unbind mine push left tap",
            'Try: neurotouch profile unbind mine "push left tap"',
        ),
        ("profile bind mine nothing at all here", "See: neurotouch profile bind --help"),
        ("run --method neurotouch --method=paper", "Write only one --method."),
        ("profile remove mine", "A profile: neurotouch profile delete. A binding: "),
    ],
)
def test_fix_names_what_was_meant(answer, line, fix):
    _, told = answer(*line.split())
    assert told.startswith(fix)


def test_numbers_are_told_as_people_write_them(answer):
    sentence, fix = answer("run", "--rate", "1e9")
    assert sentence == "Option --rate must be a number from 25 to 1000, not '1000000000.0'."
    assert fix == "For example: --rate 25"


def test_a_minus_before_a_number_or_an_axis_is_no_option():
    (command,) = [command for words, command in TREE if words == ("profile", "set")]
    context = command.make_context("set", ["mine", "push.gain", "-0.5"])
    assert context.params["value"] == "-0.5"


REFUSED = """\
import sys
from neurotouch_hid.__main__ import main
try:
    main()
except SystemExit as ended:
    print(ended.code, sorted({"numba", "cv2", "evdev"} & set(sys.modules)))
"""


@pytest.mark.parametrize(
    ("line", "code", "said"),
    [
        ("run --source foo", 3, "'foo' is not a source.\nFix: Give one of davis:"),
        ("run --source tour", 3, "'tour' is not a source.\nFix: Did you mean sim:tour?"),
        ("run --source Sim:tour", 3, "'Sim:tour' is not a source.\nFix: Did you mean sim:tour?"),
        ("run --source sim:x", 3, "There is no simulated scene called 'x'.\nFix: Scenes: "),
        (
            "run --source file:qqq.aedat4",
            4,
            "There is no file 'qqq.aedat4'.\nFix: Check the name",
        ),
        ("run --source file:plai.aedat4", 4, "Fix: Did you mean play.aedat4?"),
        ("run --source file:play.aedat4", 4, "'play.aedat4' is not an AEDAT4 recording."),
        ("run --source file:", 3, "'file:' needs the name of a recording."),
        ("demo --scene x", 3, "There is no simulated scene called 'x'."),
        ("record out.aedat4 --source foo", 3, "'foo' is not a source."),
        ("doctor --source sim:x", 3, "There is no simulated scene called 'x'."),
        ("calibrate --source sim:", 3, "'sim:' needs the name of a scene"),
        ("bench pointing --source foo", 3, "'foo' is not a source."),
        ("run --source .", 3, "'.' is not a source.\nFix: It is a folder."),
        ("evaluate nope", 4, "There is no file 'nope'."),
        ("evaluate .", 4, "'.' is a folder.\nFix: Give its recordings: ./*.aedat4"),
    ],
)
def test_wrong_source_is_refused_before_the_libraries_are_loaded(tmp_path, line, code, said):
    (tmp_path / "play.aedat4").write_text("nothing")
    done = run_command(sys.executable, "-c", REFUSED, *line.split(), code=None, cwd=tmp_path)
    assert said in done.stderr
    assert done.stdout == f"{code} []\n"


@pytest.mark.parametrize("number", ["nan", "inf", "-inf"])
@pytest.mark.parametrize("line", ["run --seconds", "run --rate", "simulate out --minutes"])
def test_what_python_calls_a_number_and_people_do_not(answer, line, number):
    sentence, _ = answer(*line.split(), number)
    assert sentence.startswith("Option ")
    assert f", not '{number}" in sentence


@pytest.mark.parametrize(
    "line",
    [
        "run --source sim:push --trace gone/x",
        "evaluate play.aedat4 --json gone/x",
        "bench --json gone/x",
        "bench pointing --simulated --json gone/x",
        "diagnostics --out gone/x",
        "doctor --picture gone/x",
    ],
)
def test_folder_that_is_missing_is_told_before_the_work(answer, line):
    sentence, fix = answer(*line.split())
    assert sentence == "There is no folder 'gone' to write 'x' to."
    assert fix == "Make the folder, or choose another."


def test_a_file_to_write_is_no_option_and_no_recording(answer, tmp_path, monkeypatch):
    """Where --json takes a file, it is easily written as if it took none."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "play.aedat4").write_bytes(b"an evening's work")
    for line in ("bench --json --help", "evaluate play.aedat4 --json --method paper"):
        sentence, fix = answer(*line.split())
        assert sentence.startswith(
            "Option --json needs the name of a file to write, not the option --"
        )
        assert fix.startswith("Write the name between the two.")
    sentence, _ = answer("bench", "--json", "-")
    assert sentence == "Option --json needs the name of a file to write, not the standard output."
    sentence, _ = answer("evaluate", "--json", "play.aedat4", "other.aedat4")
    assert sentence == "Option --json would write over the recording 'play.aedat4'."
    assert (tmp_path / "play.aedat4").read_bytes() == b"an evening's work"


@pytest.mark.parametrize(
    "line",
    [
        "diagnostics --out /proc/x",
        "doctor --picture /proc/x",
        "evaluate play.aedat4 --json /proc/x",
        "evaluate play.aedat4 --report /proc/x",
    ],
)
def test_a_place_where_nothing_can_be_written_is_told_before_the_work(
    monkeypatch, capsys, tmp_path, line
):
    """The work would be seen: the doctor announces itself, and the recording is not there."""
    monkeypatch.setattr(command_line, "handle_interrupts", lambda: None)
    monkeypatch.setattr("neurotouch_hid.recording.check_labelled", lambda files: None)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["neurotouch", *line.split()])
    with pytest.raises(SystemExit) as ended:
        command_line.main()
    printed, said = capsys.readouterr()
    assert (ended.value.code, printed) == (1, "")
    assert re.match(r"Error: .*/proc/x.*: No such file or directory\.\n", said)


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("evaluate play.aedat4 --json", "Write: --json OUT"),
        ("bench pointing --compare", "Write: --compare FILE"),
        ("run --profile", "Write: --profile TEXT"),
        ("game --port", "For example: --port 7900"),
    ],
)
def test_missing_value_says_what_to_write(answer, line, fix):
    assert answer(*line.split())[1] == fix


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("status --json --bogus", "There is no option --bogus."),
        ("profile set --json", "NAME is missing."),
        ("profile set --json --help-me mine", "There is no option --help-me."),
        ("devices --json now", "'now' is one argument too many."),
        ("calibrate --json --speed", "Option --speed needs a value."),
        ("record a.aedat4 --json --seconds 1 --seconds 2", "Option --seconds is there 2 times"),
        ("gel check sim:rest --live --json", "Option --json prints one score"),
    ],
)
def test_wrong_usage_is_json_where_a_program_reads_json(line, message):
    told = CliRunner().invoke(cli, line.split())
    answer = json.loads(told.stdout)
    assert (told.exit_code, answer["status"]) == (2, "FAILED")
    assert answer["message"].startswith(message)
    assert answer["fix"]


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (
            FileNotFoundError(2, "No such file or directory", "gone/x"),
            "Error: The file 'gone/x' cannot be used: No such file or directory.\n"
            "Fix: Make the folder, or choose another.\n",
        ),
        (
            OSError(errno.EMFILE, "Too many open files", "/proc/self/task"),
            "Error: Too many files are open.\nFix: Allow more, then try again: ulimit -n 1024\n",
        ),
        (
            OSError(errno.ENOSPC, "No space left on device"),
            "Error: The output cannot be written: No space left on device.\n",
        ),
        (
            OSError(errno.EINVAL, "Invalid argument"),
            "Error: The system refuses a call: Invalid argument.\n"
            "Fix: Find out more: neurotouch doctor\n",
        ),
        (
            RuntimeError("can't start new thread"),
            "Error: No thread can be started: too little memory, or too many processes.\n"
            "Fix: Close other programs, then try again.\n",
        ),
    ],
)
def test_what_the_system_refuses_is_a_sentence(monkeypatch, capsys, error, said):
    def fail(*_):
        raise error

    monkeypatch.setattr(command_line, "handle_interrupts", lambda: None)
    monkeypatch.setattr(command_line.cli, "make_context", fail)
    stdout = sys.stdout
    with pytest.raises(SystemExit):
        command_line.main()
    sys.stdout = stdout
    assert capsys.readouterr().err == said
