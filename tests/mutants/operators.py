"""Small changes of the functions of a module, each of which a test should notice."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass

COMPARE = {
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"),
    ast.In: ("in", "not in"),
    ast.NotIn: ("not in", "in"),
}
ARITHMETIC = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.BitAnd: ("&", "|"),
    ast.BitOr: ("|", "&"),
    ast.LShift: ("<<", ">>"),
    ast.RShift: (">>", "<<"),
}
ANNOTATIONS = {"annotation", "returns", "type_params"}


@dataclass(frozen=True)
class Mutant:
    """One change: the bytes from `begin` to `end` of the file become `text`."""

    path: str
    function: str
    line: int
    operator: str
    begin: int
    end: int
    text: str

    def apply(self, source: bytes) -> bytes:
        """Returns the changed source."""
        return source[: self.begin] + self.text.encode() + source[self.end :]

    def diff(self, source: bytes) -> tuple[str, str]:
        """Returns what the statement was and is, each in one line."""
        begin = source.rfind(b"\n", 0, self.begin) + 1
        end = len(source) if (at := source.find(b"\n", self.end)) < 0 else at
        old, new = source[begin:end], self.apply(source[: self.end]) + source[self.end : end]
        return _flat(old), _flat(new[begin:])


def find_mutants(path: str, source: bytes) -> list[Mutant]:
    """Returns every mutant of a file, in the order of the source."""
    return sorted(_Finder(path, source).find(), key=lambda m: (m.begin, m.end, m.text))


def _flat(text: bytes) -> str:
    return " ".join(text.decode().split())


class _Finder:
    def __init__(self, path: str, source: bytes) -> None:
        self._path, self._source = path, source
        lines = source.splitlines(keepends=True)
        self._starts = [sum(map(len, lines[:n])) for n in range(len(lines) + 1)]

    def find(self) -> Iterator[Mutant]:
        for name, function in _find_functions(ast.parse(self._source)):
            for statement in function.body:
                for node, parent in _walk(statement, function):
                    for operator, begin, end, text in self._changes(node, parent):
                        yield Mutant(self._path, name, node.lineno, operator, begin, end, text)

    def _changes(self, node: ast.AST, parent: ast.AST) -> Iterator[tuple[str, int, int, str]]:
        match node:
            case ast.Compare():
                sides = [node.left, *node.comparators]
                for left, op, right in zip(sides, node.ops, sides[1:], strict=False):
                    yield self._between("compare", left, right, *COMPARE[type(op)])
            case ast.BoolOp():
                words = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
                for left, right in zip(node.values, node.values[1:], strict=False):
                    yield self._between("and/or", left, right, *words)
            case ast.BinOp() if type(node.op) in ARITHMETIC and not _is_text(node):
                yield self._between("+/-", node.left, node.right, *ARITHMETIC[type(node.op)])
            case ast.UnaryOp(op=ast.Not()):
                yield self._whole("not", node, f"({self._text(node.operand)})")
            case ast.If() | ast.IfExp() if not isinstance(node.test, ast.Compare | ast.UnaryOp):
                yield self._whole("branches", node.test, f"not ({self._text(node.test)})")
            case ast.Constant(value=bool()):
                yield self._whole("constant", node, str(not node.value))
            case ast.Constant(value=int() | float()):
                yield self._whole("constant", node, f"({self._text(node)} + 1)")
                yield self._whole("constant", node, f"({self._text(node)} - 1)")
            case ast.Return(value=ast.expr() as value):
                if isinstance(value, ast.Compare | ast.BoolOp | ast.UnaryOp):
                    yield self._whole("return", value, "True")
                    yield self._whole("return", value, "False")
                elif not isinstance(value, ast.Constant):
                    yield self._whole("return", value, "None")
            case ast.Break():
                yield self._whole("break", node, "continue")
            case ast.Continue():
                yield self._whole("break", node, "break")
            case ast.Expr(value=ast.Call()) | ast.Raise() | ast.AugAssign():
                yield self._whole("delete", node, "pass")
            case ast.Assign(targets=[ast.Attribute() | ast.Subscript()]):
                if not (isinstance(parent, ast.FunctionDef) and parent.name == "__init__"):
                    yield self._whole("delete", node, "pass")

    def _span(self, node: ast.AST) -> tuple[int, int]:
        begin = self._starts[node.lineno - 1] + node.col_offset
        return begin, self._starts[node.end_lineno - 1] + node.end_col_offset

    def _text(self, node: ast.AST) -> str:
        begin, end = self._span(node)
        return self._source[begin:end].decode()

    def _whole(self, operator: str, node: ast.AST, text: str) -> tuple[str, int, int, str]:
        return operator, *self._span(node), text

    def _between(
        self, operator: str, left: ast.AST, right: ast.AST, old: str, new: str
    ) -> tuple[str, int, int, str]:
        begin, end = self._span(left)[1], self._span(right)[0]
        at = self._source.index(old.encode(), begin, end)
        return operator, at, at + len(old), new


def _is_text(node: ast.BinOp) -> bool:
    sides = (node.left, node.right)
    return any(
        isinstance(side, ast.JoinedStr)
        or (isinstance(side, ast.Constant) and isinstance(side.value, str))
        for side in sides
    )


def _find_functions(node: ast.AST, prefix: str = "") -> Iterator[tuple[str, ast.FunctionDef]]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef):
            yield prefix + child.name, child
        elif isinstance(child, ast.ClassDef):
            yield from _find_functions(child, f"{prefix}{child.name}.")


def _walk(node: ast.AST, parent: ast.AST) -> Iterator[tuple[ast.AST, ast.AST]]:
    """Every node but those of annotations and sentences."""
    yield node, parent
    for name, value in ast.iter_fields(node):
        if name in ANNOTATIONS or isinstance(node, ast.JoinedStr):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _walk(child, node)
