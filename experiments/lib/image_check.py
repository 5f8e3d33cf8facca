"""Compares images of all configurations that promise the same one, before any is measured."""
import os
import re
import shlex
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from lib import program as ptexp
from lib.description import HarnessError, Refused
from lib.program import Process


def with_options(arguments, changes):
    """The arguments, of which each option named in `changes` has that value instead. Every option
    there has one value."""
    options = dict(zip(*[iter(shlex.split(changes))] * 2))
    tokens, kept = iter(shlex.split(arguments)), []
    for token in tokens:
        if token in options:
            next(tokens)
        else:
            kept.append(token)
    return kept + [text for option in options.items() for text in option]


def commands_of(members, session):
    """{ptexp's command: the first configuration that has it}: sizes do not matter here."""
    arguments = session.arguments
    experiment = session.experiment
    changes = experiment.quick_image_check if arguments.quick else experiment.image_check
    commands = {}
    for member in members:
        command = (*shlex.split(member.launcher), member.program or str(session.program),
                   *with_options(member.arguments, changes),
                   "--device", member.device or session.device.choice, "--quiet")
        commands.setdefault(command, []).append(member)
    return commands


def render(command, path, timeout_s):
    """None, or what ptexp said instead of rendering."""
    try:
        ptexp.run_ptexp(*command, "--output", path, timeout_s=timeout_s)
    except HarnessError as error:
        return error
    return None


def differing_pixels(program, image, expected):
    found = ptexp.run_ptexp(program, "compare", image, expected)
    return int(re.search(r"(?m)^differing pixels\s+(\d+)$", found).group(1))


def check_group(group, members, session):
    """Raises HarnessError where an image differs; returns [(configuration, message)] of those that
    fail to render. A refused one is not compared: its row will say so."""
    commands = commands_of(members, session)
    failed = []
    with tempfile.TemporaryDirectory(prefix="ptexp-") as folder, \
            ThreadPoolExecutor(min(4, os.cpu_count() or 1)) as pool:
        paths = [str(Path(folder, f"{number}.exr")) for number in range(len(commands))]
        errors = pool.map(lambda job: render(*job, session.arguments.timeout),
                          zip(commands, paths))
        images = []
        for path, of_command, error in zip(paths, commands.values(), errors):
            if error is None:
                images.append((of_command[0].name, path))
            elif not isinstance(error, Refused):
                failed += [(member, f"image check: {error}") for member in of_command]
        differences = pool.map(lambda image: differing_pixels(session.program, image[1],
                                                              images[0][1]), images[1:])
        for (name, _), different in zip(images[1:], differences):
            if different:
                raise HarnessError(f"images of {name} and {images[0][0]} differ in {different} "
                                   f"pixels, expected equal bits: both are to be {group}")
    return failed


def check_images(session, journal):
    """Checks the groups that the journal does not know as equal."""
    groups = {}
    for configuration in session.configurations:
        if configuration.same_image:
            groups.setdefault(configuration.same_image, []).append(configuration)
    known = {event["group"] for event in journal.of("equal images")}
    for group, members in groups.items():
        if group in known or len(members) < 2:
            continue
        failed = check_group(group, members, session)
        for member, message in failed:
            journal.add_process(member.name, 0, Process("failed", message))
        if not failed:
            journal.add("equal images", group=group, configurations=[m.name for m in members])
