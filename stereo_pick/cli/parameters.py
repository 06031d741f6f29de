"""`stereo-pick parameters`: what can be set, as a table, as documentation, or as the nodes' YAML file."""

from __future__ import annotations

import argparse

from stereo_pick.core.params import Parameter, Value


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `parameters` subcommand."""
    parser = subparsers.add_parser(
        "parameters",
        help="list all parameters with default, range and meaning",
        description="List all parameters of the nodes and of --param, with default, range and meaning.",
    )
    parser.add_argument(
        "--format",
        choices=("markdown", "yaml"),
        default="markdown",
        help="markdown is docs/parameters.md, yaml is config/stereo_pick.yaml (default: %(default)s)",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Print the parameters."""
    print(yaml_text() if args.format == "yaml" else markdown_text(), end="")
    return 0


def nodes() -> dict[str, dict[str, Parameter]]:
    """The parameters of each node, by their full names."""
    from stereo_pick.ros.all_parameters import all_parameters  # needs ROS, which other subcommands start without

    return all_parameters()


def markdown_text() -> str:
    """The content of docs/parameters.md."""
    lines = [
        "# Parameters",
        "",
        "Made by `stereo-pick parameters` from the declarations in the code; `make docs` brings it up to date.",
        "All can be set on the nodes; those of correspondence and triangulation also with `--param NAME=VALUE`.",
        "A suffix is the unit. *fixed* ones are read once, at the start; all others can be changed while a node runs.",
    ]
    for node, parameters in nodes().items():
        for group, members in _grouped(parameters).items():
            lines += ["", f"## {node}{': ' + group if group else ''}", ""]
            lines += ["| parameter | default | range | meaning |", "| --- | --- | --- | --- |"]
            lines += [_markdown_row(name, parameter) for name, parameter in members.items()]
    return "\n".join(lines) + "\n"


def yaml_text() -> str:
    """The content of config/stereo_pick.yaml."""
    lines = ["# Every parameter with its default. Made by `stereo-pick parameters --format yaml`."]
    for node, parameters in nodes().items():
        lines += ["", f"/**/{node}:", "  ros__parameters:"]
        for group, members in _grouped(parameters).items():
            indent = "    "
            if group:
                lines.append(f"    {group}:")
                indent = "      "
            lines += [f"{indent}{_yaml_line(name, member)}" for name, member in members.items()]
    return "\n".join(lines) + "\n"


def _grouped(parameters: dict[str, Parameter]) -> dict[str, dict[str, Parameter]]:
    groups: dict[str, dict[str, Parameter]] = {}
    for name, parameter in parameters.items():
        groups.setdefault(name.rpartition(".")[0], {})[name] = parameter
    return groups


def _markdown_row(name: str, parameter: Parameter) -> str:
    legal = parameter.range_text().replace("|", "\\|")
    meaning = parameter.doc + (" *fixed*" if parameter.fixed else "")
    return f"| `{name}` | `{_yaml(parameter.default)}` | {legal} | {meaning} |"


def _yaml_line(name: str, parameter: Parameter) -> str:
    """One setting; what must be chosen is a comment, so that the file does not undo a choice on the command line."""
    unset = "# " if parameter.fixed and parameter.default in ("", 0.0) else ""
    return f"{unset}{name.rpartition('.')[2]}: {_yaml(parameter.default)}"


def _yaml(value: Value) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else repr(value)
