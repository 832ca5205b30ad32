# SPDX-License-Identifier: GPL-3.0-or-later
# usage: python_module.py CASE [ARGUMENT...]
# What test_python.c asks of the Python module; each case raises where something is wrong.
import csv
import ctypes
import math
import os
import signal
import sys
import tempfile
import threading

import numpy as np

import stdfit


def zeros(type):
    if issubclass(type, ctypes.Structure):
        return "{" + ", ".join(zeros(field) for _, field in type._fields_) + "}"
    return "{0}" if issubclass(type, ctypes.Array) else "0"


def layout():
    """Prints a C program, which prints what lines() prints."""
    print('#include "fit/stdfit.h"\n#include <stdio.h>')
    for name, struct in stdfit._header.structs.items():
        # One initialiser for each field: the compiler refuses more, and warns of fewer.
        print(f"extern const struct {name} filled_{name};")
        print(f"const struct {name} filled_{name} = {zeros(struct)};")
    print("int main(void)\n{")
    for name, struct in stdfit._header.structs.items():
        print(f'\tprintf("{name} %zu\\n", sizeof(struct {name}));')
        for field, _ in struct._fields_:
            print(f'\tprintf("{name}.{field} %zu %zu\\n", offsetof(struct {name}, {field}), '
                  f'sizeof(((struct {name} *)0)->{field}));')
    for name in stdfit._header.constants:
        print(f'\tprintf("{name} %d\\n", (int){name});')
    print("\treturn 0;\n}")


def lines():
    for name, struct in stdfit._header.structs.items():
        print(name, ctypes.sizeof(struct))
        for field, _ in struct._fields_:
            print(f"{name}.{field}", getattr(struct, field).offset, getattr(struct, field).size)
    for name, value in stdfit._header.constants.items():
        print(name, value)


def names(kind):
    print("\n".join(sorted(getattr(stdfit._header, kind))))


def model(ndf="std", gamma=1.8, **parameters):
    return stdfit.Model(stdfit.Distribution(ndf, 0.1, gamma), n=1.5, kd=(0.35, 0.04, 0.03), ks=(0.5, 0.5, 0.25),
                        **parameters)


def raises(kind, part, call, *arguments, **options):
    try:
        call(*arguments, **options)
    except kind as error:
        assert part in str(error), f"expected '{part}' in '{error}'"
        return error
    raise AssertionError(f"expected {kind}")


def evaluate(path):
    """The values that the program wrote, at its angles."""
    table = stdfit.Measurement(path)
    assert table.n_phi_d == 180
    values = table.values()
    assert values.shape == (3, 90, 90, 180)
    compared = 0
    for i, j, k in ((0, 0, 0), (1, 20, 40), (30, 50, 90), (9, 70, 179), (60, 3, 5)):
        angles = np.radians([i * i / 90, j, k])
        wi, wo = np.empty(3), np.empty(3)
        stdfit._call("angles_to_directions", 1, angles.ctypes.data, wi.ctypes.data, wo.ctypes.data)
        f = stdfit.evaluate(model(), wi, wo)
        assert f.shape == (3,)
        if wi[2] > 0 and wo[2] > 0:
            np.testing.assert_allclose(values[:, i, j, k], f, rtol=2e-7)
            compared += 1
    assert compared >= 4
    metrics = stdfit.compare(table, model())
    assert max(metrics.error) < 1e-6 and metrics.entries > 3e6
    assert stdfit.compare(table, model(fresnel="none")).error[0] > 0.1
    # What is written back is what was read.
    with tempfile.TemporaryDirectory() as folder:
        copy = os.path.join(folder, "copy.binary")
        stdfit.Measurement(values).write(copy)
        np.testing.assert_array_equal(stdfit.Measurement(copy).values(), values)


def arrays():
    rng = np.random.default_rng(1)
    wi, wo = rng.normal(size=(2, 7, 5, 3))
    wi[..., 2], wo[..., 2] = abs(wi[..., 2]), abs(wo[..., 2])
    wi /= np.linalg.norm(wi, axis=-1)[..., None]
    wo /= np.linalg.norm(wo, axis=-1)[..., None]
    # What is contiguous goes as it is.
    assert stdfit._directions(wi) is wi
    out = np.full((7, 5, 3), np.nan)
    f = stdfit.evaluate(model(), wi, wo, out=out)
    assert f is out and np.all(f > 0)
    # Red, green, blue are the last axis.
    lobe = f - np.array((0.35, 0.04, 0.03)) / np.pi
    np.testing.assert_allclose(lobe[..., 0], lobe[..., 1], rtol=1e-9)
    np.testing.assert_allclose(lobe[..., 0], 2 * lobe[..., 2], rtol=1e-9)
    # Other strides, other types, one direction against many.
    strided = np.asfortranarray(wi)
    np.testing.assert_array_equal(stdfit.evaluate(model(), strided, wo), f)
    np.testing.assert_array_equal(stdfit.evaluate(model(), wi[2, 3], wo)[2, 3], f[2, 3])
    np.testing.assert_array_equal(stdfit.evaluate(model(), wi.tolist(), wo), f)
    raises(ValueError, "(..., 3)", stdfit.evaluate, model(), wi[..., :2], wo[..., :2])
    raises(ValueError, "(7, 5, 3)", stdfit.evaluate, model(), wi, wo, out=np.empty((7, 5)))
    raises(ValueError, "contiguous", stdfit.evaluate, model(), wi, wo, out=np.empty((3, 5, 7)).T)
    raises(TypeError, "Model", stdfit.evaluate, "std", wi, wo)
    ggx = stdfit.Distribution("ggx", 0.3)
    assert math.isclose(ggx.D([0, 0, 1]), 1 / (math.pi * 0.09), rel_tol=1e-14)
    np.testing.assert_allclose(ggx.G1(wi), 1 / (1 + ggx.Lambda(wi)), rtol=1e-14)


def sample():
    for ndf, gamma in (("std", 1.8), ("beckmann", np.inf), ("gtr", 1.7)):
        for theta in (0.3, 1.2):
            wi = np.array((np.sin(theta), 0, np.cos(theta)))
            wo, pdf = stdfit.sample(model(ndf, gamma), wi, 40000, rng=4)
            assert wo.shape == (40000, 3) and pdf.shape == (40000,) and np.all(pdf > 0)
            weight = stdfit.evaluate(model(ndf, gamma), wi, wo) * np.maximum(wo[:, 2:], 0) / pdf[:, None]
            spread = 4 * weight.std(axis=0) / np.sqrt(len(wo))
            error = abs(weight.mean(axis=0) - stdfit.albedo(model(ndf, gamma), wi[2]))
            assert np.all(error < spread) and np.all(spread < 0.02), (ndf, theta, error, spread)


def errors():
    error = raises(stdfit.Error, "none-such", stdfit.Distribution, "none-such", 0.1)
    assert isinstance(error, ValueError) and error.status == "STDFIT_DOMAIN"
    error = raises(OSError, "no-such-file", stdfit.fit, "no-such-file")
    assert isinstance(error, stdfit.IoError) and error.status == "STDFIT_IO"
    ones = np.ones((3, 90, 90, 180))
    raises(stdfit.NoDataError, "", stdfit.fit, -ones, "ggx")
    raises(ValueError, "(3, 90, 90, n_phi_d)", stdfit.Measurement, ones[0])
    raises(stdfit.DomainError, "n_phi_d", stdfit.Measurement, ones[..., :90])
    raises(stdfit.UnsupportedError, "", stdfit.Distribution, "ggx", 0.1, form="2f1")
    raises(TypeError, "no option colour", stdfit.fit, ones, "ggx", colour=1)
    raises(TypeError, "no option trace", stdfit.fit, ones, "ggx", trace=1)
    raises(stdfit.DomainError, "starts", stdfit.fit, ones, "ggx", starts=2**32 + 1)
    raises(stdfit.DomainError, "starts", stdfit.fit, ones, "ggx", starts=1.5)
    raises(stdfit.DomainError, "zero byte", stdfit.fit, ones, "ggx\0")
    raises(stdfit.DomainError, "weight", stdfit.fit, ones, "ggx", weight="heavy")
    raises(stdfit.DomainError, "3 numbers in kd", stdfit.evaluate, stdfit.Model(stdfit.Distribution("ggx", 1), kd=(1, 2)),
           (0, 0, 1), (0, 0, 1))


def stops():
    signal.signal(signal.SIGINT, signal.default_int_handler)
    ones = stdfit.Measurement(np.ones((3, 90, 90, 180)))
    seen = []

    def interrupt(step):
        seen.append(step)
        os.kill(os.getpid(), signal.SIGINT)

    raises(KeyboardInterrupt, "", stdfit.fit, ones, "std", progress=interrupt, starts=100000)
    assert seen[0].ndf == "std" and seen[0].stage == "scan" and seen[0].error > 0

    def fails(step):
        raise LookupError("of the caller's")

    raises(LookupError, "of the caller's", stdfit.fit, ones, "std", progress=fails, starts=100000)
    assert threading.active_count() == 1


def fit(path, table):
    """Writes as `stdfit fit PATH` did, number by number."""
    with open(table, newline="") as file:
        rows = list(csv.DictReader(file))
    steps = []
    fits = stdfit.fit_all(path, [row["ndf"] for row in rows], progress=steps.append)
    assert len(fits) == len(rows) == 2 and {step.stage for step in steps} > {"scan", "full"}
    for found, row in zip(fits, rows):
        assert found.ndf == row["ndf"] and found.converged == 1
        for name, value in (("error", found.error), ("sigma", found.sigma), ("ior", found.model.n),
                            ("kd_r", found.model.kd[0]), ("kd_b", found.model.kd[2]), ("ks_g", found.model.ks[1]),
                            ("error_cosine", found.metrics.error[1]), ("samples", found.metrics.entries),
                            ("evaluations", found.evaluations)):
            assert float(row[name]) == value, (name, row[name], value)
    # The distribution lives as long as the model does.
    kept = fits[0].model
    del fits, found
    assert stdfit.evaluate(kept, (0, 0, 1), (0, 0, 1))[0] > 1
    # Fixed parameters and options; an array in place of the file.
    values = stdfit.Measurement(path).values()
    fixed = stdfit.fit(values, "ggx", n=1.5, sigma=0.1, weight="cosine", gray=True)
    assert fixed.sigma == 0.1 and fixed.model.n == 1.5 and len(set(fixed.model.kd)) == 1
    assert fixed.error == fixed.metrics.error[1]
    assert not set(fixed.at_bound) - {"kd_r", "kd_g", "kd_b", "ks_r", "ks_g", "ks_b"}


if __name__ == "__main__":
    globals()[sys.argv[1]](*sys.argv[2:])
