"""Commands that measure: check, bench, tradeoff, reproduce."""

import pathlib
from typing import Annotated

import typer

from melt.cli import DIFFERENT, app, console
from melt.cli.options import PRECISIONS, Backend, known
from melt.errors import MeltError

Out = Annotated[pathlib.Path | None, typer.Option("--output", "-o", help="File for the results (HDF5).")]


@app.command("check")
def check(
    stages: Annotated[
        list[str] | None, typer.Argument(metavar="STAGE", help="Stages; all unless given.")
    ] = None,
    backends: Annotated[
        list[str] | None, typer.Option("--backend", "-b", help="Backend to check (repeat).")
    ] = None,
    precisions: Annotated[
        list[str] | None, typer.Option("--precision", help="single, mixed, double (repeat).")
    ] = None,
    out: Out = None,
    capsule: Annotated[
        pathlib.Path | None, typer.Option("--capsule", metavar="FILE", help="Replay the call on which a run failed.")
    ] = None,
):
    """Cross-check stages: reference, CPU and CUDA on the same inputs; exit code 3 on a difference."""
    from melt.check import replay, report
    from melt.stages import STAGES

    if capsule is not None:
        if stages or precisions or out:
            raise MeltError("--capsule has its own stage, inputs and precision: give it alone, or with --backend")
        known("backend", backends, (*report.BACKENDS, "cuda"))
        if replay.main(capsule, backends, console()):
            raise typer.Exit(DIFFERENT)
        return
    known("stage", stages, STAGES)
    known("backend", backends, (*report.BACKENDS, "cuda"))
    known("precision", precisions, PRECISIONS)
    failures = report.main(
        stages or None,
        tuple(backends) if backends else report.BACKENDS,
        tuple(precisions) if precisions else report.PRECISIONS,
        out=out,
    )
    if failures:
        raise typer.Exit(DIFFERENT)


@app.command("bench")
def bench(
    sizes: Annotated[
        list[int] | None, typer.Argument(metavar="PARTICLES", help="Liquid particles; a series unless given.")
    ] = None,
    backend: Backend = "cpu",
    precision: Annotated[str, typer.Option("--precision", help="single, mixed or double.")] = "single",
    threads: Annotated[list[int] | None, typer.Option("--threads", help="CPU threads (repeat).")] = None,
    steps: Annotated[int, typer.Option("--steps", min=1, help="Steps to take the median of.")] = 10,
    iterations: Annotated[
        int | None, typer.Option("--pbf", min=1, max=255, help="Iterations: time a dam break of the position based fluid.")
    ] = None,
    dfsph: Annotated[bool, typer.Option("--dfsph", help="Time a splashing dam break of DFSPH, then with viscosity.")] = False,
    flood: Annotated[bool, typer.Option("--flood", help="Time shallow water that runs apart over hills.")] = False,
    support: Annotated[float, typer.Option("--support", min=1.6, max=6, help="Support radius of --pbf and --dfsph in spacings.")] = 2.0,
    render: Annotated[bool, typer.Option("--render", help="Time the screen-space renderer, at the first PARTICLES.")] = False,
    out: Out = None,
):
    """Time the stages: milliseconds, nanoseconds per pair, scaling with particles and threads."""
    from melt import bench as benchmark
    from melt import bench_screen, bench_slime

    if render:
        bench_screen.run(sizes[0] if sizes else bench_screen.PARTICLES, backend, frames=2 * steps, say=typer.echo)
        return

    known("precision", [precision], PRECISIONS)
    if dfsph:
        given = tuple(sizes) if sizes else bench_slime.SIZES
        bench_slime.run(given, backend, precision, support, steps=2 * steps, out=out, say=typer.echo)
        return
    benchmark.run(
        tuple(sizes) if sizes else benchmark.SIZES,
        backend,
        precision,
        tuple(threads) if threads else (1, 2),
        steps,
        out=out,
        say=typer.echo,
        iterations=iterations,
        support=support,
        flood=flood,
    )


@app.command("tradeoff")
def tradeoff(
    scene: Annotated[str | None, typer.Argument(metavar="SCENE", help="Name of a shipped scene, or path of a .toml file.")] = None,
    steps: Annotated[int | None, typer.Option("--steps", min=1, help="Outer steps of each run; as many as fit unless given.")] = None,
    within: Annotated[str, typer.Option("--within", metavar="TIME", help="About how long the whole sweep takes.")] = "120 s",
    seeds: Annotated[int, typer.Option("--seeds", min=1, max=20, help="Repetitions of each point; their scatter is its spread.")] = 2,
    keep: Annotated[bool, typer.Option("--store", help="Store the front, from which presets are taken.")] = False,
    every: Annotated[bool, typer.Option("--all", help="All shipped scenes; those whose stored front is fresh are skipped.")] = False,
    out: Out = None,
):
    """Measure what the knobs of a scene cost and what error they bring: points, Pareto front, presets."""
    from melt import units
    from melt.dial import sweep
    from melt.scene import find_scene, shipped_scenes

    if (scene is None) != every:
        raise MeltError("name one SCENE, or give --all without one")
    if every and out:
        raise MeltError("--output is for one scene: leave it out with --all")
    options = dict(steps=steps, within=units.duration(within, "--within"), seeds=seeds, keep=keep, say=typer.echo)
    if not every:
        find_scene(scene)
        sweep.run(scene, out, **options)
    elif failed := sweep.run_all(shipped_scenes(), options):
        raise MeltError(f"{len(failed)} of {len(shipped_scenes())} scenes could not be measured: {', '.join(failed)}")


@app.command("reproduce")
def reproduce(
    name: Annotated[
        str | None, typer.Argument(metavar="TABLE", help="Paper table or figure; lists them unless given.")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Scaled down: shows that it runs.")] = False,
    out: Out = None,
):
    """Repeat an experiment of the paper: paper beside ours; exit code 3 if a bound is missed."""
    from melt import reproduce as study

    if name is None:
        typer.echo("\n".join(study.names()))
    elif not study.run(name, out, quick, say=typer.echo):
        raise typer.Exit(DIFFERENT)
