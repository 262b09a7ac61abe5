"""Error messages for unknown commands and options of the command line."""

import click


class CommandGroupWithSuggestions(click.Group):
    """A group of commands. The error message for an unknown command suggests the most similar command, or
    lists all commands."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Name, command and arguments from the words `args` of the command line, as in click; raises
        click.UsageError for an unknown command."""
        name = args[0]
        if ctx.resilient_parsing or name.startswith("-") or self.get_command(ctx, name) is not None:
            return super().resolve_command(ctx, args)
        from ..config.document.refusals import dotted_key, unknown_key_hint

        suggestion = unknown_key_hint(name, self.list_commands(ctx), "the commands are")
        raise click.UsageError(f"unknown command {dotted_key([name])}; {suggestion}", ctx)


def usage_error_text(error: click.UsageError) -> str:
    """Message for a click error. For an option that names a diameter it suggests the option of the radius."""
    if not isinstance(error, click.NoSuchOption) or error.ctx is None:
        return error.format_message()
    from ..model.arm.quantities import radius_name_of_diameter

    option_names = [parameter.name or "" for parameter in error.ctx.command.params]
    radius = radius_name_of_diameter(error.option_name.lstrip("-"), option_names)
    if not radius:
        return error.format_message()
    return f"unknown option {error.option_name}; give --{radius.replace('_', '-')}, half of it"
