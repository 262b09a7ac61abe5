"""Functions of an algebra: loops over its structure constants, written out before they are compiled.

What is nonlinear in the rod is the same formula on se(2) and on se(3). As loops at run time it takes two to
three times as long as written out by hand: a loop over 4 terms costs more than its products. So `OverAlgebra`
writes it out, from the syntax tree of the function, for each algebra that it is asked for:

- a loop over something that the algebra alone determines, `for a in g.components`, becomes its turns,
- a condition on such a thing becomes what it decides for, and a number of this kind a constant,
- of a list with an item for each, `E = [... for a in g.components]`, each item becomes a variable of its own.

Called as it is, with the algebra before the other arguments, the function is ordinary Python.
"""

import ast
import inspect
from collections.abc import Callable, Iterable, Mapping
from copy import deepcopy
from textwrap import dedent
from typing import Any, Concatenate, Generic, ParamSpec, TypeVar

from .algebra import Algebra
from .compilation import compiled_for_vectors

P = ParamSpec("P")
R = TypeVar("R")

ALWAYS = {"range": range}
"""What else a loop that is written out may use."""


class OverAlgebra(Generic[P, R]):
    """A function whose first argument is an algebra; decorates it."""

    def __init__(self, function: Callable[Concatenate[Algebra, P], R]) -> None:
        self.function: Any = function
        self._compiled: dict[Algebra, Callable[P, R]] = {}

    def __call__(self, g: Algebra, *args: P.args, **kwargs: P.kwargs) -> R:
        result: R = self.function(g, *args, **kwargs)
        return result

    def of(self, g: Algebra) -> Callable[P, R]:
        """The function for one algebra, without that argument, compiled as `compiled_for_vectors` does."""
        if g not in self._compiled:
            self._compiled[g] = compiled_for_vectors(self.written_out(g))
        return self._compiled[g]

    def written_out(self, g: Algebra) -> Callable[P, R]:
        """The function for one algebra before it is compiled, calling others like it that are."""
        tree = ast.parse(dedent(inspect.getsource(self.function)))
        ast.increment_lineno(tree, self.function.__code__.co_firstlineno - 1)
        definition: Any = tree.body[0]
        first = definition.args.args.pop(0).arg
        definition.decorator_list, definition.returns = [], None
        for argument in definition.args.args:
            argument.annotation = None
        namespace = {"__name__": self.function.__module__}
        others = set()
        for name in {part.id for part in ast.walk(definition) if isinstance(part, ast.Name)}:
            value = self.function.__globals__.get(name)
            if isinstance(value, OverAlgebra):
                others.add(name)
                namespace[name] = value.of(g)
            elif name in self.function.__globals__:
                namespace[name] = value
        tree.body = [_Writer({first: g, **ALWAYS}, set(), others).visit(definition)]
        exec(compile(ast.fix_missing_locations(tree), self.function.__code__.co_filename, "exec"), namespace)
        written: Any = namespace[definition.name]
        return written


class _Writer(ast.NodeTransformer):
    """Writes out what `known` determines.

    `lists`: names of the lists whose items are variables; `others`: functions whose first argument goes.
    """

    def __init__(self, known: Mapping[str, Any], lists: set[str], others: set[str]) -> None:
        self.known, self.lists, self.others = known, lists, others

    def visit(self, node: ast.AST) -> Any:
        if isinstance(node, ast.expr) and self._is_known(node) and not isinstance(_context(node), ast.Store):
            value = self._value(node)
            if isinstance(value, int | float):
                return ast.copy_location(ast.Constant(value), node)
        return super().visit(node)

    def visit_For(self, node: ast.For) -> Any:
        if not self._is_known(node.iter):
            return self.generic_visit(node)
        leaves = ast.Break | ast.Continue | ast.Return
        if node.orelse or any(isinstance(part, leaves) for part in ast.walk(node)):
            raise TypeError(f"line {node.lineno}: a loop that is written out is left at its end alone")
        return [
            statement
            for item in self._value(node.iter)
            for statement in self._under(_bound(node.target, item), node.body)
        ]

    def visit_If(self, node: ast.If) -> Any:
        if not self._is_known(node.test):
            return self.generic_visit(node)
        return self._under({}, node.body if self._value(node.test) else node.orelse)

    def visit_IfExp(self, node: ast.IfExp) -> Any:
        if not self._is_known(node.test):
            return self.generic_visit(node)
        return self.visit(node.body if self._value(node.test) else node.orelse)

    def visit_Assign(self, node: ast.Assign) -> Any:
        target, value = node.targets[0], node.value
        if not (isinstance(value, ast.ListComp) and isinstance(target, ast.Name)):
            return self.generic_visit(node)
        self.lists.add(target.id)
        loop, written = value.generators[0], []
        for place, item in enumerate(self._value(loop.iter)):
            name = ast.Name(f"{target.id}_{place}", ast.Store())
            one = ast.copy_location(ast.Assign([name], value.elt), node)
            written += self._under(_bound(loop.target, item), [one])
        return written

    def visit_Subscript(self, node: ast.Subscript) -> Any:
        inner = self.visit(node.value)
        if isinstance(inner, ast.Name) and inner.id in self.lists:
            return ast.copy_location(ast.Name(f"{inner.id}_{self._value(node.slice)}", node.ctx), node)
        return ast.copy_location(ast.Subscript(inner, self.visit(node.slice), node.ctx), node)

    def visit_Call(self, node: ast.Call) -> Any:
        if isinstance(node.func, ast.Name) and node.func.id in self.others:
            node.args = node.args[1:]
        return self.generic_visit(node)

    def _under(self, more: Mapping[str, Any], body: Iterable[ast.stmt]) -> list[ast.stmt]:
        """A copy of the statements, written out with more that is known."""
        writer = _Writer({**self.known, **more}, self.lists, self.others)
        block = writer.visit(ast.Module([deepcopy(statement) for statement in body], []))
        return list(block.body)

    def _is_known(self, node: ast.AST) -> bool:
        names = {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}
        return bool(names) and names <= self.known.keys()

    def _value(self, node: ast.expr) -> Any:
        """NameError: it is not known."""
        expression = ast.fix_missing_locations(ast.Expression(deepcopy(node)))
        return eval(compile(expression, "<known>", "eval"), {"__builtins__": {}}, dict(self.known))


def _context(node: ast.expr) -> ast.expr_context:
    return getattr(node, "ctx", ast.Load())


def _bound(target: ast.expr, item: Any) -> dict[str, Any]:
    """The names that one turn of a loop gives values to."""
    if isinstance(target, ast.Tuple):
        pairs = zip(target.elts, item, strict=True)
        return {name: value for part, inner in pairs for name, value in _bound(part, inner).items()}
    assert isinstance(target, ast.Name)
    return {target.id: item}
