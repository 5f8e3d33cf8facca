"""Sets the page: first screen, scenes, causes, claims, a section for each experiment, pictures, and
the list of tables that have no section."""
import re
from html import escape
from pathlib import Path
from string import Template
from urllib.parse import quote

from . import first, html, plots
from .answers import CAUSES, OTHERS
from .claims import claims_table
from .devices import side_by_side
from .images import image_section
from .modes import MOST_DAYS, silent, verdicts
from .submitted import other_devices
from .verdicts import meaning
from .words import SAME

HERE = Path(__file__).parent


def asset(name):
    return (HERE / name).read_text(encoding="utf-8")


def anchor(name):
    return "".join(letter if letter.isalnum() else "-" for letter in name)


def for_each(devices, make):
    """What `make` says of each device, under its name where there are several."""
    if len(devices) == 1:
        return make(devices[0])
    return '<div class="beside">' + "".join(
        f'<div><h3 class="device">{escape(device.name)}</h3>{make(device)}</div>'
        for device in devices) + "</div>"


def articles(questions, devices):
    return "".join(f'<article class="answer"><h3>{question}</h3>{for_each(devices, answer)}'
                   "</article>" for question, answer in questions)


def first_screen(device):
    """The answer, its limits and the map."""
    answer = escape(first.answer_text(device)).replace(first.AUTO, f"<code>{first.AUTO}</code>")
    return (f'<div class="first"><div><p class="answer-text">{answer}</p>'
            f"{html.facts_list(first.limits(device))}</div>"
            f"{first.mode_map(verdicts(device))}</div>")


def table_list(device):
    """The tables that have no section here: where they are, and why they have none."""
    rows = []
    for table in device.tables.values():
        why = reason_without_section(table, device)
        if why:
            rows.append(f'<li><a href="{quote(table.name, safe="")}.csv">'
                        f"{escape(html.caption_of(table))}</a>: {escape(why)}</li>")
    return f'<ul class="files">{"".join(rows)}</ul>' if rows else "<p>None.</p>"


def reason_without_section(table, device):
    if not table.facts:
        return "a plain table of a log page"
    return silent(device).get(table.name, "")


def figures(table, shared):
    panels = plots.draw_panels(table, shared)
    kind = f"; thin lines with ends: {table.kind}" if table.kind else ""
    return '<div class="panels">' + "".join(
        f"<figure><figcaption>{escape(panel)}</figcaption>"
        f"{plots.in_page(height, content, f'{plots.title_of(table)}: {panel}')}</figure>"
        for panel, height, content in panels) + (
            f'</div><p class="note">{escape(plots.title_of(table))}. Medians'
            f"{kind}.</p>")


def environment(table):
    facts, device = table.facts, table.facts.get("device", {})
    gpus = [f"{head}: {value}" for line in facts.get("gpus", [])[1:]
            for head, value in zip(facts["gpus"][0].split(", "), line.split(", "))]
    host = facts.get("host", {})
    return html.facts_list([
        ("date", facts.get("date", "")), ("program", "; ".join(facts.get("program", []))),
        ("commits of the rows", ", ".join(table.commits)),
        ("device", ", ".join(filter(None, (device.get("name"), device.get("detail"))))),
        ("GPU", "; ".join(gpus)),
        ("host", ", ".join(str(host[key]) + (" cores" if key == "cores" else "")
                           for key in ("cpu", "cores", "system") if host.get(key)))])


def sentences(table):
    return "".join(f"<p>{f'<b>{escape(panel)}.</b> ' if panel else ''}{escape(text)}</p>"
                   for panel, text in meaning(table))


def own_words(table):
    lines = table.facts.get("conclusions") or []
    if "law" in table.facts:  # its conclusions are its meaning
        return ""
    return ("<details><summary>What the experiment itself concludes</summary><ul>"
            + "".join(f"<li>{escape(line)}</li>" for line in lines) + "</ul></details>"
            ) if lines else ""


def without_folders(command):
    """Where files lay on the machine that measured tells nothing: their last two names do."""
    return re.sub(r"(?<![\w.])/(?:[\w.+-]+/)+(?=[\w.+-]+/[\w.+-]+)", "…/", command)


def on_a_device(table, shared):
    parts = []
    if table.facts.get("quick"):
        parts.append('<p class="warning">Made with --quick: small images that only show that it '
                     "runs. These numbers say nothing about speed.</p>")
    if table.facts.get("command"):
        command = escape(without_folders(table.facts["command"]))
        parts.append(f'<p class="method">Method: <code>{command}</code></p>')
    if table.drawn:
        parts.append(figures(table, shared))
    parts.append(f'<div class="meaning">{sentences(table)}</div>{own_words(table)}')
    rows = html.table_of(table) if table.rows else '<p class="note">The table has no rows.</p>'
    parts.append(f"<h3>{escape(table.name)}.csv</h3>{rows}{html.stages_of(table)}")
    if table.facts:
        parts.append(f"<details><summary>Environment</summary>{environment(table)}</details>")
    return "".join(parts)


def experiment(name, devices):
    there = [device for device in devices if name in device.tables
             and not reason_without_section(device.tables[name], device)]
    tables = [device.tables[name] for device in there]
    drawn = [table for table in tables if table.drawn]
    shared = plots.domains(drawn) if drawn else None
    title, _, question = tables[0].facts.get("question", name).partition(": ")
    body = for_each(there, lambda device: on_a_device(device.tables[name], shared))
    if len(there) < len(devices):
        body = f'<p class="note">Measured on {escape(there[0].name)} alone.</p>' + body
    elif len(devices) == 2 and drawn:
        body = side_by_side([device.name for device in there], tables, drawn[0].plot["y"]) + body
    return (f'<section class="experiment" id="{anchor(name)}"><h2>{escape(title)}</h2>'
            f'<p class="question">{escape(question)}</p>{body}</section>')


def tell_apart(devices):
    """Two folders of one device are named with their folders."""
    if len({device.name for device in devices}) < len(devices):
        for device in devices:
            device.name = f"{device.name} ({device.folder.name})"


def has_section(name, devices):
    """Of one device alone the first sections say what tables that ask for the mode say."""
    there = [device for device in devices if name in device.tables]
    tables = [device.tables[name] for device in there]
    answered = len(devices) == 1 and any(verdict.table.name == name
                                         for verdict in verdicts(devices[0]).values())
    return not answered and any(not reason_without_section(table, device)
                                for table, device in zip(tables, there))


def page(devices, limit_bytes, submissions=()):
    tell_apart(devices)
    names = [name for name in dict.fromkeys(name for device in devices for name in device.tables)
             if has_section(name, devices)]
    pictures = "".join(image_section(device.folder, limit_bytes) for device in devices)
    pictures = pictures and f'<section id="images"><h2>Images</h2>{pictures}</section>'
    return Template(asset("page.html")).substitute(
        title=escape(" and ".join(device.name for device in devices)), style=asset("page.css")
        + asset("plot.css"), script=asset("page.js"), first=for_each(devices, first_screen),
        same=f"{100 * SAME:g}\u00a0%", days=MOST_DAYS, scenes=for_each(devices, first.scene_table),
        causes=articles(CAUSES, devices), others=articles(OTHERS, devices),
        contents="".join(f'<a href="#{anchor(name)}">{escape(name.replace("_", " "))}</a>'
                         for name in names), claims=for_each(devices, claims_table),
        submitted=other_devices(devices, submissions),
        experiments="\n".join(experiment(name, devices) for name in names), images=pictures,
        files=for_each(devices, table_list))
