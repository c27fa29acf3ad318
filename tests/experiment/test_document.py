"""YAML read with places, and everything hostile about it refused in time."""

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.errors import InputError
from harness.experiment.document import KEY, read_document, read_value
from harness.experiment.scalar import resolve


def problems(text: str | bytes) -> list[str]:
    with pytest.raises(InputError) as caught:
        read_document(text, "f.yaml")
    return [str(problem) for problem in caught.value.problems]


def test_values_and_keys_know_their_places() -> None:
    document = read_document("a: 1\nscene:\n  box: [1, 2,\n    x]\n", "f.yaml")
    assert document.value == {"a": 1, "scene": {"box": [1, 2, "x"]}}
    assert document.place(("scene", "box", 2)) == (4, 5)
    assert document.place(("scene", "box", KEY)) == (3, 3)
    assert document.place(("scene", "box")) == (3, 8)
    assert document.place(("scene", "nothing")) == document.place(("scene",))
    assert document.place(("scene", "a tag", "box", 1)) == (3, 12)


def test_numbers_are_read_as_people_write_them() -> None:
    wanted = {
        "1e-6": 1e-6,
        "1.0e-6": 1e-6,
        "1_000": 1000,
        "1/60": 1 / 60,
        "1 / 60": 1 / 60,
        "-1/4": -0.25,
        ".5": 0.5,
        "1.": 1.0,
        "+5": 5,
        "010": 10,
    }
    for text, value in wanted.items():
        assert resolve(text) == value, text
        assert type(resolve(text)) is type(value), text


def test_what_only_looks_like_a_number_stays_text() -> None:
    for text in ("1:30", "2020-01-01", "0x10", "1.2.3", "inf", "nan", "y", "n", "1/", "/60", "9" * 1000, "1e", "_1"):
        assert resolve(text) == text


def test_quoted_scalars_stay_text() -> None:
    assert read_value('["1/60", \'on\', "5", ""]') == ["1/60", "on", "5", ""]


def test_on_and_off_are_booleans_and_nothing_is_null() -> None:
    assert read_value("[on, off, yes, No, TRUE, false, ~, null]") == [True, False, True, False, True, False, None, None]
    assert read_value("") is None


def test_a_zero_below_the_line_is_an_error_at_its_place() -> None:
    assert read_document("a: 5\nb: 1/0", "f.yaml").problems[0].line == 2
    with pytest.raises(InputError, match="1/0 divides by zero"):
        read_value("1/0")


def test_a_duplicate_key_is_refused_and_the_first_one_named() -> None:
    document = read_document("a: 1\nb: 2\na: 3\n", "f.yaml")
    assert [str(problem) for problem in document.problems] == ['f.yaml:3:1: duplicate key "a"; the first is in line 1']
    assert document.value == {"a": 1, "b": 2}


def test_tags_are_refused() -> None:
    for tag in ("!!python/object/apply:os.system", "!x", "!", "!!str"):
        assert "tags" in str(read_document(f"a: {tag} [b]", "f.yaml").problems[0])


def test_anchors_may_be_repeated() -> None:
    document = read_document("a: &x {b: 1}\nc: *x\n", "f.yaml")
    assert document.value["c"] == {"b": 1}
    assert document.place(("c", "b")) == (1, 11)


def test_an_alias_bomb_is_refused() -> None:
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 40)]
    assert "too many" in problems("\n".join(lines))[0]


def test_aliases_cannot_hide_depth_or_cycles() -> None:
    lines = ["a0: &a0 [x]", *(f"a{i}: &a{i} [*a{i - 1}]" for i in range(1, 60))]
    assert "nested more than 50 deep, aliases written out" in problems("\n".join(lines))[0]
    assert "refers to the value it stands in" in problems("a: &a [*a]")[0]
    assert problems("abc: &abd 1\nb: *abc") == ['f.yaml:2:4: *abc refers to nothing; did you mean "abd"?']


def test_the_rest_of_yaml_that_is_left_out() -> None:
    assert "merge keys" in problems("a: &a {b: 1}\nc:\n  <<: *a")[0]
    assert problems("a: 1\n---\nb: 2")[0].startswith("f.yaml:2:1: a second document")
    assert "must be a mapping" in problems("[1, 2]")[0]
    assert "must be a mapping" in problems("5")[0]
    assert "a key must be text" in str(read_document("5: 1", "f.yaml").problems[0])
    assert "a key must be text" in str(read_document("on: 1", "f.yaml").problems[0])
    assert "a key must be text" in str(read_document("? [a, b]\n: 1", "f.yaml").problems[0])
    assert read_document("'<<': 1", "f.yaml").value == {"<<": 1}


@pytest.mark.parametrize("text", ["", "\n\n", "# only words\n", "\ufeff"])
def test_an_empty_file_says_how_to_begin(text: str) -> None:
    assert "harness new" in problems(text)[0]


def test_text_that_is_not_utf8_or_not_printable_is_refused_at_its_place() -> None:
    assert problems(b"a: 1\nb: \xff\xfe") == ["f.yaml:2:4: the file is not UTF-8 text"]
    assert problems("a: 1\nb: \x00") == ["f.yaml:2:4: the character U+0000 is not allowed; YAML is printable text"]
    assert "control character" in str(read_document('a: "\\e[31m"', "f.yaml").problems[0])


def test_utf8_with_a_byte_order_mark_and_windows_lines_is_fine() -> None:
    document = read_document("\ufeffa: grüße\r\nb: 2\r\n".encode(), "f.yaml")
    assert document.value == {"a": "grüße", "b": 2}
    assert document.place(("b",)) == (2, 4)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a: [1, 2", "f.yaml:1:4"),
        ("a: b: c", 'f.yaml:1:5: this is not YAML: a ": " stands where no key can be'),
        ("a:\n\t- b", "f.yaml:2:1: this is not YAML"),
        ('a: "x', "a quotation mark is never closed"),
        ("a: @b", "no value can start with this character"),
    ],
)
def test_what_is_not_yaml_is_said_in_one_sentence(text: str, said: str) -> None:
    (problem,) = problems(text)
    assert "\n" not in problem
    assert said in problem or said.startswith("f.yaml:1:4")


@pytest.mark.slow
@pytest.mark.parametrize(
    "junk",
    [
        "[" * 10**6,
        "{" * 10**6,
        "- " * 499_999,
        "? " * 499_999,
        "[1," + "1," * 400_000,
        "a" * 999_999 + ":",
        "!" * 10**6,
        '"' + "a" * 999_998,
        "&a " * 300_000,
        "a: " + "1" * 999_000,
        "- 1/" + "1" * 900_000,
        "\n".join(["a: 1"] * 200_000),
    ],
    ids=lambda junk: junk[:6],
)
def test_a_megabyte_of_junk_is_refused_fast(junk: str) -> None:
    start = time.perf_counter()
    try:
        read_document(junk, "f.yaml")
    except InputError as error:
        assert all(len(str(problem)) < 300 for problem in error.problems)  # noqa: PT017
    assert time.perf_counter() - start < 30


def test_a_file_of_more_than_a_megabyte_is_refused() -> None:
    assert "larger than 1 MB" in problems("a" * 1_000_001)[0]


@given(st.binary(max_size=300))
def test_bytes_of_any_kind_are_read_or_refused(junk: bytes) -> None:
    try:
        read_document(junk, "f.yaml")
    except InputError as error:
        assert all(problem.file == "f.yaml" for problem in error.problems)  # noqa: PT017


YAML_PIECES = [
    "[",
    "]",
    "{",
    "}",
    ": ",
    "- ",
    "\n",
    "  ",
    "&a ",
    "*a",
    "a",
    "'",
    '"',
    "# ",
    "!x ",
    "| ",
    "? ",
    ", ",
    "1",
]


@given(st.lists(st.sampled_from([*YAML_PIECES, "<<", "---\n", "1/0", "\t", "%"]), max_size=40).map("".join))
def test_pieces_of_yaml_in_any_order_are_read_or_refused(text: str) -> None:
    try:
        read_document(text, "f.yaml")
    except InputError as error:
        assert error.problems  # noqa: PT017


PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text("abcäß _-\n", max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text("abc", min_size=1, max_size=3), inner),
    max_leaves=20,
)


@given(PLAIN)
def test_what_pyyaml_writes_is_read_back(value: object) -> None:
    import yaml

    assert read_value(yaml.safe_dump(value, allow_unicode=True)) == value
