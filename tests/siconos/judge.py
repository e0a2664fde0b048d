#!/usr/bin/env python3
"""Interface problems between stickslip, Siconos and fclib, each read and solved by the others.

    apt-get install -y python3-siconos python3-scipy libfclib0
    cargo build && /usr/bin/python3 tests/siconos/judge.py [--stickslip target/debug/stickslip]

1. Global problems (M, H, f, b) that Siconos writes, dense and sparse: its own reduction and Lemke's method beside stickslip.
2. Frozen problems of built-in scenes that stickslip writes (.dat, .mtx, .h5): the .dat is solved by Siconos, the .mtx is read
   by scipy, the .h5 by fclib itself, and all three must have the same numbers to the last bit.
3. Problems in space that Siconos writes, solved by its NSGS and by stickslip.

Every answer r of Siconos is judged here by the laws, since some of its methods call NaN a success. It ends with code 1 if
anything differs by more than 1e-9 of the largest force, or 1e-7 in space.
"""
import argparse
import contextlib
import csv
import ctypes
import io
import os
import subprocess
import sys
import tempfile

import numpy as np
import scipy.io
import siconos.numerics as sn

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CLOSE = 1e-9
# Both stop at an error: stickslip's is 1e-9 of the forces.
CLOSE_IN_SPACE = 1e-7
# Scenes whose frozen problem has a compliance, where their unknowns move both ways.
SCENES = ("02-two-cantilevers-rough", "05-cantilever-elastic-block", "osc-inclined-cantilever", "osc-two6", "osc-three10", "osc-touch2", "osc-snap")


def stickslip(program, *arguments):
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 3):
        raise SystemExit(f"stickslip {' '.join(arguments)}: {done.stderr}")
    return done.stdout


def forces(program, file):
    """F_n and F_t of each contact in turn, of the last minor iteration."""
    rows = list(csv.DictReader(io.StringIO(stickslip(program, "run", file, "-q", "--trace", "-"))))
    nodes = list(dict.fromkeys(row["node"] for row in rows))
    return np.array([float(row[key]) for row in rows[-len(nodes):] for key in ("f_n", "f_t")])


def lawful(w, q, mu, r):
    """By how much u = W r + q and r break Signorini's and Coulomb's laws, relatively."""
    u = w @ r + q
    force = max(np.abs(r).max(), 1e-300)
    length = max(np.abs(q).max(), np.abs(u).max(), 1e-300)
    worst = 0.0
    for k, coefficient in enumerate(mu):
        (un, ut), (rn, rt) = u[2 * k : 2 * k + 2], r[2 * k : 2 * k + 2]
        worst = max(worst, -un / length, -rn / force, abs(un * rn) / (length * force))
        worst = max(worst, (abs(rt) - coefficient * rn) / force)
        worst = max(worst, abs(ut * rt + coefficient * rn * abs(ut)) / (length * force))
    return worst


def solved(problem, w, q, mu):
    """Siconos' first answer that obeys the laws."""
    size = len(q)
    for name in ("LEMKE", "CPG", "NSGS"):
        options = sn.SolverOptions(getattr(sn, f"SICONOS_FRICTION_2D_{name}"))
        options.dparam[sn.SICONOS_DPARAM_TOL] = 1e-14
        options.iparam[sn.SICONOS_IPARAM_MAX_ITER] = 1_000_000
        r, u = np.zeros(size), np.zeros(size)
        try:
            sn.fc2d_driver(problem, r, u, options)
        except Exception as error:  # noqa: BLE001
            print(f"      {name}: {error}")
            continue
        if np.isfinite(r).all() and lawful(w, q, mu, r) < 1e-8:
            return name, r
    return None, None


@contextlib.contextmanager
def hushed():
    """Without what Siconos' own C says on standard output."""
    sys.stdout.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def space_problem(contacts, folder):
    """Contacts of a block that is pressed down and turned; numbers that are the same in every file."""
    random = np.random.default_rng(contacts)
    size = 3 * contacts
    factor = np.round(random.normal(size=(size, size)), 3) / 8
    w = np.round(np.eye(size) + factor @ factor.T, 6)
    q = np.round(random.normal(size=size), 3)
    q[::3] -= 0.5
    mu = np.round(random.uniform(0.1, 0.6, contacts), 3)
    problem = sn.FrictionContactProblem(3, w, q, mu)
    file = os.path.join(folder, f"space-{contacts}.dat")
    sn.frictionContact_printInFilename(problem, file)
    options = sn.SolverOptions(sn.SICONOS_FRICTION_3D_NSGS)
    options.dparam[sn.SICONOS_DPARAM_TOL] = 1e-13
    options.iparam[sn.SICONOS_IPARAM_MAX_ITER] = 100_000
    r, u = np.zeros(size), np.zeros(size)
    with hushed():
        sn.fc3d_driver(problem, r, u, options)
    return file, r


def space_forces(program, file):
    """F_n and |F_t| of each contact in turn."""
    rows = list(csv.DictReader(io.StringIO(stickslip(program, "run", file, "-q", "--trace", "-"))))
    nodes = list(dict.fromkeys(row["node"] for row in rows))
    return np.array([[float(row[key]) for key in ("f_n", "f_t")] for row in rows[-len(nodes) :]])


def dense(matrix):
    return np.asarray(matrix.todense()) if hasattr(matrix, "todense") else np.asarray(matrix)


def text_problem(file):
    """W, q, mu of a dense problem as stickslip writes it: full digits, which Siconos' reader keeps."""
    numbers = open(file, encoding="utf-8").read().split()
    contacts = int(numbers[1])
    size = 2 * contacts
    assert numbers[2] == "0"
    values = np.array([float(x) for x in numbers[7:]])
    w = values[: size * size].reshape(size, size).T
    return w, values[size * size : size * size + size], values[size * size + size :]


class Matrix(ctypes.Structure):
    _fields_ = [
        ("nzmax", ctypes.c_int), ("m", ctypes.c_int), ("n", ctypes.c_int),
        ("p", ctypes.POINTER(ctypes.c_int)), ("i", ctypes.POINTER(ctypes.c_int)),
        ("x", ctypes.POINTER(ctypes.c_double)), ("nz", ctypes.c_int), ("info", ctypes.c_void_p),
    ]  # fmt: skip


class LocalProblem(ctypes.Structure):
    _fields_ = [
        ("W", ctypes.POINTER(Matrix)), ("V", ctypes.c_void_p), ("R", ctypes.c_void_p),
        ("mu", ctypes.POINTER(ctypes.c_double)), ("q", ctypes.POINTER(ctypes.c_double)),
        ("s", ctypes.c_void_p), ("spacedim", ctypes.c_int), ("info", ctypes.c_void_p),
    ]  # fmt: skip


def fclib_problem(file):
    """W, q, mu as fclib itself reads them."""
    library = ctypes.CDLL("libfclib.so.0")
    library.fclib_read_local.restype = ctypes.POINTER(LocalProblem)
    library.fclib_read_local.argtypes = [ctypes.c_char_p]
    found = library.fclib_read_local(file.encode())
    if not found:
        raise SystemExit(f"fclib cannot read {file}")
    problem, matrix = found.contents, found.contents.W.contents
    assert problem.spacedim == 2 and matrix.nz == -1
    w = np.zeros((matrix.m, matrix.n))
    for column in range(matrix.n):
        for k in range(matrix.p[column], matrix.p[column + 1]):
            w[matrix.i[k], column] += matrix.x[k]
    size = matrix.m
    return w, np.array(problem.q[:size]), np.array(problem.mu[: size // 2])


def global_problem(kind, folder):
    """Four masses on springs, two of which touch; numbers that six digits tell."""
    k = np.array([[6.0, 1.0, -2.0, 0.0], [1.0, 5.0, 0.5, -1.0], [-2.0, 0.5, 7.0, 1.0], [0.0, -1.0, 1.0, 8.0]])
    m = np.kron(np.eye(2), k)
    m[0, 4] = m[4, 0] = -0.5
    h = np.zeros((8, 4))
    h[1, 0], h[0, 1], h[7, 2], h[6, 3] = 1.0, -1.0, 1.0, -1.0
    problem = sn.globalFrictionContactProblem_new()
    problem.dimension, problem.numberOfContacts = 2, 2
    if kind == "sparse":
        problem.M, problem.H = scipy.sparse.csc_matrix(m), scipy.sparse.csc_matrix(h)
    else:
        problem.M, problem.H = m, h
    f = np.array([0.5, -4.0, 1.0, 0.25, -2.0, 0.5, 3.0, -5.0])
    b, mu = np.array([0.125, 0.0, 0.0625, 0.25]), np.array([0.3, 0.5])
    problem.q, problem.b, problem.mu = f, b, mu
    file = os.path.join(folder, f"global-{kind}.dat")
    sn.globalFrictionContact_printInFileName(problem, file)
    inverse = np.linalg.inv(m)
    return file, problem, h.T @ inverse @ h, b + h.T @ inverse @ f, mu


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--stickslip", default=os.path.join(ROOT, "target", "debug", "stickslip"))
    program = options.parse_args().stickslip
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        print("global problems that Siconos writes")
        for kind in ("dense", "sparse"):
            file, problem, w, q, mu = global_problem(kind, folder)
            # The same problem both times; Siconos reduces the dense one to a dense W, which it writes with all digits.
            if kind == "dense":
                reduced = os.path.join(folder, "reduced.dat")
                with hushed():
                    local = sn.globalFrictionContact_reformulation_FrictionContact(problem)
                    sn.frictionContact_printInFilename(local, reduced)
                    name, theirs = solved(local, w, q, mu)
                their_w, their_q, _ = text_problem(reduced)
                apart = max(np.abs(their_w - w).max(), np.abs(their_q - q).max())
                wrong += apart > CLOSE
                print(f"  Siconos' W and q are {apart:.1e} from Hᵀ M⁻¹ H and b + Hᵀ M⁻¹ f; its forces by {name}: {np.round(theirs, 9)}")
            ours = forces(program, file)
            error = np.abs(ours - theirs).max() / np.abs(theirs).max()
            wrong += error > CLOSE
            print(f"  {kind:8} read by stickslip: forces {error:.1e} from Siconos'")
        print("problems in space that Siconos writes")
        for contacts in (3, 10, 40):
            file, r = space_problem(contacts, folder)
            ours = space_forces(program, file)
            theirs = np.column_stack([r[::3], np.hypot(r[1::3], r[2::3])])
            error = np.abs(ours - theirs).max() / np.abs(theirs).max()
            wrong += error > CLOSE_IN_SPACE
            print(f"  {contacts:3} contacts: forces {error:.1e} from Siconos' NSGS")
        print("frozen problems that stickslip writes")
        for scene in SCENES:
            base = os.path.join(folder, scene)
            names = {"dat": base + ".dat", "mtx": base + "_W.mtx", "h5": base + ".h5"}
            for name in names.values():
                stickslip(program, "export", scene, "--frozen", "--force", "-o", name)
            w, q, mu = text_problem(names["dat"])
            part = {key: np.asarray(scipy.io.mmread(f"{base}_{key}.mtx")).ravel() for key in ("q", "mu")}
            market = (dense(scipy.io.mmread(names["mtx"])), part["q"], part["mu"])
            same = all(
                np.array_equal(one, other)
                for read in (market, fclib_problem(names["h5"]))
                for one, other in zip((w, q, mu), read)
            )
            with hushed():
                name, theirs = solved(sn.frictionContact_new_from_filename(names["dat"]), w, q, mu)
            runs = [forces(program, file) for file in names.values()]
            wrong += not same
            told = f"  {scene:28} {len(mu):3} contacts, all three files {'the same' if same else 'DIFFER'}"
            least = np.linalg.eigvalsh(0.5 * (w + w.T)).min()
            if least < -1e-12 * np.abs(w).max():
                print(f"{told}; W is indefinite: several answers, or none, so forces are not compared")
                continue
            laws = max(lawful(w, q, mu, ours) for ours in runs)
            apart = max(np.abs(ours - theirs).max() for ours in runs) / max(np.abs(theirs).max(), 1e-300)
            wrong += laws > 1e-8 or apart > CLOSE
            print(f"{told}; laws {laws:.1e}; forces {apart:.1e} from {name}'s")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
