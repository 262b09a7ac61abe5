"""Functions of a Lie algebra, with loops over structure constants that are unrolled before compilation.

The nonlinear terms of the rod have the same formula on se(2) and se(3). Loops at run time would take two to
three times as long as unrolled code: a loop over 4 terms costs more than the products. `UnrolledOverAlgebra`
therefore unrolls the syntax tree of a function for each requested algebra g:

- a loop over a value that depends only on g, `for a in g.component_indices`, becomes a list of statements,
- a condition that depends only on g is replaced by the chosen branch, a number by a constant,
- a list comprehension over g, `E = [... for a in g.component_indices]`, becomes one variable per element.

A direct call, with the algebra as first argument, runs the function as ordinary Python.
"""

import ast
import inspect
from collections.abc import Callable, Iterable, Mapping
from textwrap import dedent
from types import CodeType
from typing import Any, Concatenate, Generic, NamedTuple, ParamSpec, TypeVar

from ..lie_algebra import LieAlgebra
from .compilation import compiled_with_reordered_sums

P = ParamSpec("P")
R = TypeVar("R")

ALWAYS_KNOWN_VALUES = {"range": range}
"""Names with known values during unrolling, in addition to the algebra."""


class UnrolledOverAlgebra(Generic[P, R]):
    """Decorator of a function whose first argument is a Lie algebra; `compiled_for` unrolls loops over it."""

    def __init__(self, function: Callable[Concatenate[LieAlgebra, P], R]) -> None:
        self.function: Any = function
        self._compiled: dict[LieAlgebra, Callable[P, R]] = {}

    def __call__(self, g: LieAlgebra, *args: P.args, **kwargs: P.kwargs) -> R:
        result: R = self.function(g, *args, **kwargs)
        return result

    def compiled_for(self, g: LieAlgebra) -> Callable[P, R]:
        """The function for the algebra `g`, unrolled and compiled, without the argument for the algebra."""
        if g not in self._compiled:
            # Compiled once per algebra: each compilation takes seconds.
            self._compiled[g] = compiled_with_reordered_sums(self.unrolled_for(g))
        return self._compiled[g]

    def unrolled_for(self, g: LieAlgebra) -> Callable[P, R]:
        """The function as Python code whose loops over the Lie algebra `g` are unrolled. The function itself
        is not compiled, but the functions with this decorator that it calls are unrolled and compiled.
        """
        # The source is unrolled rather than the bytecode, which has no loops to recognise.
        tree = ast.parse(dedent(inspect.getsource(self.function)))
        # Tracebacks then show the lines of the original file.
        ast.increment_lineno(tree, self.function.__code__.co_firstlineno - 1)
        definition: Any = tree.body[0]
        algebra_name = definition.args.args.pop(0).arg
        # Otherwise the decorator would wrap the copy once more.
        definition.decorator_list = []
        definition.returns = None
        for argument in definition.args.args:
            argument.annotation = None
        namespace = {"__name__": self.function.__module__}
        called_functions = set()
        for name in {part.id for part in ast.walk(definition) if isinstance(part, ast.Name)}:
            value = self.function.__globals__.get(name)
            if isinstance(value, UnrolledOverAlgebra):
                called_functions.add(name)
                # Called functions are specialised for the same algebra, which then is no argument any more.
                namespace[name] = value.compiled_for(g)
            elif name in self.function.__globals__:
                namespace[name] = value
        tree.body = [
            _UnrollingTransformer(
                {algebra_name: g, **ALWAYS_KNOWN_VALUES}, _UnrollingState(set(), called_functions, {}, {})
            ).visit(definition)
        ]
        exec(compile(ast.fix_missing_locations(tree), self.function.__code__.co_filename, "exec"), namespace)
        function: Any = namespace[definition.name]
        return function


class _UnrollingState(NamedTuple):
    """State shared by all `_UnrollingTransformer` objects that unroll one function.

    unrolled_lists: names of lists with elements that became variables. unrolled_functions: names of called
    functions that are also unrolled. names_read: cache of the names that a syntax node reads.
    compiled_expressions: cache of compiled expressions.
    """

    unrolled_lists: set[str]
    unrolled_functions: set[str]
    names_read: dict[ast.AST, frozenset[str]]
    compiled_expressions: dict[ast.AST, CodeType]


class _UnrollingTransformer(ast.NodeVisitor):
    """Copies a syntax tree. Expressions of names in `known_values` are replaced by their values if these are
    numbers, and loops over known values are unrolled."""

    def __init__(self, known_values: Mapping[str, Any], state: _UnrollingState) -> None:
        self.known_values = known_values
        self.shared_state = state

    def visit(self, node: ast.AST) -> Any:
        is_read = isinstance(node, ast.expr) and not isinstance(getattr(node, "ctx", None), ast.Store)
        if is_read and self._has_known_value(node) and isinstance(value := self._evaluate(node), int | float):
            return ast.copy_location(ast.Constant(value), node)
        return super().visit(node)

    def generic_visit(self, node: ast.AST) -> Any:
        fields = {
            name: self._visit_all(value) if isinstance(value, list) else self._visit_node_or_keep_value(value)
            for name, value in ast.iter_fields(node)
        }
        return ast.copy_location(type(node)(**fields), node)

    def visit_For(self, node: ast.For) -> Any:
        if not self._has_known_value(node.iter):
            return self.generic_visit(node)
        jump_statements = ast.Break | ast.Continue | ast.Return
        # Without a loop in the result such a statement would have no loop to act on.
        if node.orelse or any(isinstance(part, jump_statements) for part in ast.walk(node)):
            raise TypeError(f"line {node.lineno}: an unrolled loop has no break, continue, return or else")
        iterations = [
            self._transformer_with_loop_variable(node.target, item)._visit_all(node.body)
            for item in self._evaluate(node.iter)
        ]
        return [statement for iteration in iterations for statement in iteration]

    def visit_If(self, node: ast.If) -> Any:
        if not self._has_known_value(node.test):
            return self.generic_visit(node)
        return self._visit_all(node.body if self._evaluate(node.test) else node.orelse)

    def visit_IfExp(self, node: ast.IfExp) -> Any:
        if not self._has_known_value(node.test):
            return self.generic_visit(node)
        return self.visit(node.body if self._evaluate(node.test) else node.orelse)

    def visit_Assign(self, node: ast.Assign) -> Any:
        target = node.targets[0]
        value = node.value
        if not (isinstance(value, ast.ListComp) and isinstance(target, ast.Name)):
            return self.generic_visit(node)
        # A list of arrays costs compiled code an allocation and references; separate names cost nothing.
        self.shared_state.unrolled_lists.add(target.id)
        loop = value.generators[0]
        assignments = []
        for index, item in enumerate(self._evaluate(loop.iter)):
            name = ast.copy_location(ast.Name(f"{target.id}_{index}", ast.Store()), target)
            assignment = ast.copy_location(ast.Assign([name], value.elt), node)
            copies = self._transformer_with_loop_variable(loop.target, item).visit(assignment)
            assignments += copies if isinstance(copies, list) else [copies]
        return assignments

    def visit_Subscript(self, node: ast.Subscript) -> Any:
        inner = self.visit(node.value)
        if isinstance(inner, ast.Name) and inner.id in self.shared_state.unrolled_lists:
            return ast.copy_location(ast.Name(f"{inner.id}_{self._evaluate(node.slice)}", node.ctx), node)
        return ast.copy_location(ast.Subscript(inner, self.visit(node.slice), node.ctx), node)

    def visit_Call(self, node: ast.Call) -> Any:
        call = self.generic_visit(node)
        if isinstance(call.func, ast.Name) and call.func.id in self.shared_state.unrolled_functions:
            # The first argument is the algebra, which the compiled function does not have.
            call.args = call.args[1:]
        return call

    def _transformer_with_loop_variable(self, target: ast.expr, item: Any) -> "_UnrollingTransformer":
        """The transformer for the body of one loop iteration, in which `target` has the value `item`."""
        return _UnrollingTransformer(
            {**self.known_values, **_loop_variable_values(target, item)}, self.shared_state
        )

    def _visit_all(self, parts: Iterable[Any]) -> list[Any]:
        copies = [self._visit_node_or_keep_value(part) for part in parts]
        return [part for copy in copies for part in (copy if isinstance(copy, list) else [copy])]

    def _visit_node_or_keep_value(self, part: Any) -> Any:
        return self.visit(part) if isinstance(part, ast.AST) else part

    def _has_known_value(self, node: ast.AST) -> bool:
        """Whether an expression contains names, and all of them have known values."""
        names = self._names_read_by(node)
        # A bare constant has no name and is copied unchanged.
        return bool(names) and names <= self.known_values.keys()

    def _names_read_by(self, node: ast.AST) -> frozenset[str]:
        """Names in a syntax node and all its children, cached."""
        names = self.shared_state.names_read.get(node)
        if names is None:
            own_name = {node.id} if isinstance(node, ast.Name) else ()
            names = frozenset(own_name).union(*map(self._names_read_by, ast.iter_child_nodes(node)))
            self.shared_state.names_read[node] = names
        return names

    def _evaluate(self, node: Any) -> Any:
        """Value of the expression `node`. Raises NameError if a name in it is not in `known_values`."""
        code = self.shared_state.compiled_expressions.get(node)
        if code is None:
            code = compile(ast.Expression(node), "<known>", "eval")
            self.shared_state.compiled_expressions[node] = code
        # Known values need no builtins, and an accidental call shows as an error.
        return eval(code, {"__builtins__": {}}, dict(self.known_values))


def _loop_variable_values(target: ast.expr, item: Any) -> dict[str, Any]:
    """Values of the variables in the loop target `target`, by name, in the iteration with value `item`."""
    if isinstance(target, ast.Tuple):
        pairs = zip(target.elts, item, strict=True)
        return {
            name: value for part, inner in pairs for name, value in _loop_variable_values(part, inner).items()
        }
    assert isinstance(target, ast.Name)
    return {target.id: item}
