# SPDX-License-Identifier: GPL-3.0-or-later
"""stdfit - fits Cook-Torrance models to measured BRDFs, evaluates and samples them, over libstdfit and numpy.

    import stdfit
    best = stdfit.fit("nickel.binary", "std")
    f = stdfit.evaluate(best.model, wi, wo)
    wo, pdf = stdfit.sample(best.model, wi, 1000)

The surface normal is +z; a direction is a unit vector of three numbers, an array of directions has the shape (..., 3).
Contiguous arrays of float64 go to the library as they are, others are copied first. Choices are strings, as on the
command line. What the library refuses is an Error, which says what was expected and what was found.

`make` puts the declarations of the C header into this file; all structs, options and results below follow them.
"""

import ctypes
import dataclasses
import os
import re
import threading
import weakref

import numpy as np

_DECLARATIONS = """
@DECLARATIONS@
"""
_LIBRARY = "@LIBRARY@"
_VERSION = "@VERSION@"

# ---- The header ----

_NUMBERS = {
    "char": ctypes.c_char, "int": ctypes.c_int, "unsigned": ctypes.c_uint, "long": ctypes.c_long,
    "size_t": ctypes.c_size_t, "uint64_t": ctypes.c_uint64, "float": ctypes.c_float, "double": ctypes.c_double,
}


class _Header:
    """What preprocessed C declares: structs, constants, and the result and parameters of functions. It knows as much of C
    as the header has, and raises ImportError at anything else."""

    def __init__(self, text):
        self.structs, self.constants, self.functions, self.handles = {}, {}, {}, set()
        for declaration in re.findall(r"\S(?:[^;{]|\{[^}]*\})*;", text):
            self._read(" ".join(declaration[:-1].split()))

    def _read(self, text):
        if match := re.fullmatch(r"typedef struct (\w+) (\w+)", text):
            self.handles.add(match[2])
        elif match := re.fullmatch(r"enum \w+ \{(.*)\}", text):
            value = -1
            for item in match[1].split(","):
                name, _, given = (part.strip() for part in item.partition("="))
                if name:
                    value = int(given, 0) if given else value + 1
                    self.constants[name] = value
        elif match := re.fullmatch(r"struct (\w+) \{(.*)\}", text):
            fields = [field for part in match[2].split(";") if part.strip() for field in self._variables(part.strip())]
            self.structs[match[1]] = type(match[1], (ctypes.Structure,), {"_fields_": fields})
        elif match := re.fullmatch(r"([\w *]*[ *])(\w+) ?\((.*)\)", text):
            (_, result), = self._variables(match[1] + " result")
            self.functions[match[2]] = result, self._parameters(match[3])
        else:
            raise ImportError("stdfit: a declaration that is not understood: " + text)

    def _parameters(self, text):
        if text.strip() == "void":
            return []
        # An array is passed as a pointer.
        types = [type for part in text.split(",") for _, type in self._variables(part.strip())]
        return [ctypes.c_void_p if issubclass(type, ctypes.Array) else type for type in types]

    def _variables(self, text):
        """Names and types of `const double *a, b[3]`."""
        if match := re.fullmatch(r"void \(\*(\w+)\)\((.*)\)", text):
            return [(match[1], ctypes.CFUNCTYPE(None, *self._parameters(match[2])))]
        constant = text.startswith("const ")
        base, names = re.fullmatch(r"((?:struct |enum )?\w+)(.*)", re.sub(r"\b(const|volatile)\b ?", "", text)).groups()
        variables = []
        for name in names.split(","):
            match = re.fullmatch(r" *([* ]*)(\w*)((?:\[\d+\])*)", name)
            if not match:
                raise ImportError("stdfit: a variable that is not understood: " + text)
            type = self._type(base, match[1].count("*"), constant)
            for size in reversed(re.findall(r"\d+", match[3])):
                type *= int(size)
            variables.append((match[2], type))
        return variables

    def _type(self, base, stars, constant):
        """Handles and arrays of numbers are plain addresses."""
        kind, _, name = base.rpartition(" ")
        if stars == 0 and base == "void":
            return None
        if kind == "struct":
            if stars > 1:
                return ctypes.c_void_p
            return ctypes.POINTER(self.structs[name]) if stars else self.structs[name]
        if base == "char" and stars == 1 and constant:
            return ctypes.c_char_p
        if stars and (base == "void" or base in _NUMBERS or base in self.handles):
            return ctypes.c_void_p
        return ctypes.c_int if kind == "enum" else _NUMBERS[base]


def _load():
    header = _Header(_DECLARATIONS)
    # The soname finds the library where the system looks, if it is not where `make install` put it.
    path = os.environ.get("STDFIT_LIBRARY") or (_LIBRARY if os.path.exists(_LIBRARY) else os.path.basename(_LIBRARY))
    library = ctypes.CDLL(path)
    for name, (result, parameters) in header.functions.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, parameters
    found = library.stdfit_version().decode()
    if found != _VERSION:
        raise ImportError(f"stdfit: expected version {_VERSION} of the library, found {found} in {path}")
    return header, library


_header, _lib = _load()
__version__ = _VERSION


def _struct(name):
    return _header.structs["stdfit_" + name]


# ---- Errors ----

class Error(Exception):
    """What the library refused; `status` is the name of its status, such as "STDFIT_DOMAIN". Each status is a class of
    its own, which is a Python error as well where there is one alike: DomainError is a ValueError, IoError an OSError."""

    status = None


def _error_classes():
    alike = {"DOMAIN": (ValueError,), "NO_MEMORY": (MemoryError,), "IO": (OSError,), "FORMAT": (ValueError,),
             "NO_DATA": (ValueError,), "UNSUPPORTED": (NotImplementedError,)}
    classes = {}
    for name in re.search(r"enum stdfit_status \{([^}]*)\}", _DECLARATIONS)[1].split(","):
        name = name.split("=")[0].strip().removeprefix("STDFIT_")
        if name != "OK":
            title = "".join(word.capitalize() for word in name.split("_")) + "Error"
            bases = (Error, *alike.get(name, ()))
            classes[_header.constants["STDFIT_" + name]] = type(title, bases, {"status": "STDFIT_" + name, "__doc__": None})
    return classes


_errors = _error_classes()
globals().update((error.__name__, error) for error in _errors.values())


def _call(name, *arguments):
    """Calls a function whose last parameter is the error."""
    error = _struct("error")()
    status = getattr(_lib, "stdfit_" + name)(*arguments, ctypes.byref(error))
    if status != _header.constants["STDFIT_OK"]:
        raise _errors.get(status, Error)(error.text.decode(errors="replace"))


# ---- Between Python and C ----

def _bytes(text):
    if text is None:
        return None
    text = os.fsencode(text)
    if b"\0" in text:
        raise DomainError("expected text without a zero byte")
    return text


def _assign(struct, name, value):
    """Sets a field; what it cannot hold is an error, where ctypes would cut it off."""
    type = dict(struct._fields_)[name]
    if type is ctypes.c_char_p:
        setattr(struct, name, _bytes(value if isinstance(value, str) or value is None else ",".join(value)))
    elif issubclass(type, ctypes.Array):
        if len(value) != type._length_:
            raise DomainError(f"expected {type._length_} numbers in {name}, found {len(value)}")
        setattr(struct, name, type(*value))
    else:
        setattr(struct, name, float(value) if type is ctypes.c_double else int(value))
        if type is not ctypes.c_double and getattr(struct, name) != value:
            raise DomainError(f"expected a whole number in {name}, found {value}")


def _value(value):
    if isinstance(value, bytes):
        return value.decode()
    return tuple(value) if isinstance(value, ctypes.Array) else value


def _names_of_bits(bits):
    return tuple(_lib.stdfit_parameter_name(1 << i).decode() for i in range(32) if bits >> i & 1)


def _fields(struct, but=()):
    return [name for name, _ in _struct(struct)._fields_ if name not in but]


def _directions(array):
    array = np.ascontiguousarray(array, dtype=np.float64)
    if array.shape[-1:] != (3,):
        raise ValueError(f"expected an array of the shape (..., 3), found {array.shape}")
    return array


def _pairs(wi, wo):
    if np.shape(wi) != np.shape(wo):
        wi, wo = np.broadcast_arrays(wi, wo)
    return _directions(wi), _directions(wo)


def _result(shape, out=None):
    if out is None:
        return np.empty(shape)
    if out.shape != shape or out.dtype != np.float64 or not out.flags.c_contiguous or not out.flags.writeable:
        raise ValueError(f"expected in out a writeable contiguous array of float64 of the shape {shape}")
    return out


class _Handle:
    """Something of the library's, freed with the object."""

    def _own(self, free, address):
        self._as_parameter_ = ctypes.c_void_p(address)
        weakref.finalize(self, free, self._as_parameter_)

    def _make(self, name, free, *arguments):
        address = ctypes.c_void_p()
        _call(name, ctypes.byref(address), *arguments)
        self._own(free, address.value)


# ---- Distributions and models ----

class Distribution(_Handle):
    """A distribution of normals by its name, roughness and shape: "std", "ggx", "beckmann", ..."""

    def __init__(self, name, sigma, gamma=np.inf, sigma_y=None, form=None):
        self._make("ndf_new", _lib.stdfit_ndf_free, _bytes(name), sigma, sigma if sigma_y is None else sigma_y, gamma,
                   _bytes(form))

    def _evaluate(self, quantity, directions, out):
        directions = _directions(directions)
        out = _result(directions.shape[:-1], out)
        _call("ndf_evaluate", self, _header.constants[quantity], out.size, directions.ctypes.data, out.ctypes.data)
        return out

    def D(self, normals, out=None):
        """The density of normals, 1/sr."""
        return self._evaluate("STDFIT_D", normals, out)

    def Lambda(self, directions, out=None):
        """Smith's Lambda."""
        return self._evaluate("STDFIT_LAMBDA", directions, out)

    def G1(self, directions, out=None):
        """Masking, 1/(1 + Lambda)."""
        return self._evaluate("STDFIT_G1", directions, out)

    def sample(self, u):
        """Normals of density D cos, from numbers u in [0, 1), of the shape (n, 2)."""
        u = np.ascontiguousarray(u, dtype=np.float64).reshape(-1, 2)
        normals = np.empty((len(u), 3))
        _call("ndf_sample", self, len(u), u.ctypes.data, normals.ctypes.data)
        return normals

    def pdf(self, normals, out=None):
        """The density of sample(), 1/sr."""
        return self._evaluate("STDFIT_PDF", normals, out)

    def sample_visible(self, wi, u):
        """Normals as they are seen from wi, from numbers u in [0, 1), of the shape (n, 2)."""
        u = np.ascontiguousarray(u, dtype=np.float64).reshape(-1, 2)
        wi, normals = _directions(wi).reshape(3), np.empty((len(u), 3))
        _call("ndf_sample_visible", self, wi.ctypes.data, len(u), u.ctypes.data, normals.ctypes.data)
        return normals

    def pdf_visible(self, wi, normals, out=None):
        """The density of sample_visible(), 1/sr."""
        wi, normals = _directions(wi).reshape(3), _directions(normals)
        out = _result(normals.shape[:-1], out)
        _call("ndf_pdf_visible", self, wi.ctypes.data, out.size, normals.ctypes.data, out.ctypes.data)
        return out


def _dataclass(name, doc, fields):
    made = dataclasses.make_dataclass(name, fields, namespace={"__doc__": doc})
    made.__module__ = __name__
    return made


_default_model = _lib.stdfit_model_default()
Model = _dataclass("Model", "A model: its distribution, and struct stdfit_model of the header.", [
    ("distribution", Distribution),
    *((name, object, dataclasses.field(default=_value(getattr(_default_model, name)))) for name in _fields("model"))])
Metrics = _dataclass("Metrics", "How far a model is from a measurement: struct stdfit_metrics of the header.",
                     [(name, object) for name in _fields("metrics")])
Step = _dataclass("Step", "What a fit reports: struct stdfit_step of the header.",
                  [(name, object) for name in _fields("step")])
Fit = _dataclass("Fit", "The fit of one distribution: struct stdfit_result of the header. The distribution is the "
                 "model's; at_bound and undetermined are names of parameters.",
                 [(name, object) for name in _fields("result", but=("distribution",))])


def _c_model(model):
    model = getattr(model, "model", model)
    if not isinstance(model, Model):
        raise TypeError(f"expected a Model or a Fit, found {type(model).__name__}")
    struct = _struct("model")()
    for name in _fields("model"):
        _assign(struct, name, getattr(model, name))
    return struct, model.distribution


def _from_struct(made, struct):
    return made(**{name: _value(getattr(struct, name)) for name, _ in struct._fields_})


def _fit_of(result):
    """A Fit of a struct stdfit_result, whose distribution it takes over."""
    distribution = Distribution.__new__(Distribution)
    distribution._own(_lib.stdfit_ndf_free, result.distribution)
    result.distribution = None
    values = {name: _value(getattr(result, name)) for name in _fields("result", but=("distribution",))}
    values["model"] = Model(distribution, **{name: _value(getattr(result.model, name)) for name in _fields("model")})
    values["metrics"] = _from_struct(Metrics, result.metrics)
    for name in ("at_bound", "undetermined"):
        values[name] = _names_of_bits(values[name])
    return Fit(**values)


def evaluate(model, wi, wo, out=None):
    """The BRDF f, 1/sr, of a Model or a Fit: an array of the shape of wi and wo, red, green and blue in place of x, y, z."""
    struct, distribution = _c_model(model)
    wi, wo = _pairs(wi, wo)
    out = _result(wi.shape, out)
    _call("model_evaluate", ctypes.byref(struct), distribution, out.size // 3, wi.ctypes.data, wo.ctypes.data,
          out.ctypes.data)
    return out


def albedo(model, cos_i):
    """The share of the light from a direction of cosine cos_i that is sent back, in three channels."""
    struct, distribution = _c_model(model)
    out = np.empty(3)
    _call("model_albedo", ctypes.byref(struct), distribution, cos_i, out.ctypes.data)
    return out


def sample(model, wi, n, rng=None):
    """n directions wo for one wi, and their density, 1/sr: the mean of f cos_o/pdf over them is the albedo. Half of them
    are normals that wi sees, as mirrors; half are spread as the diffuse part spreads light; a part that the model has not
    gets none. A wo below the horizon is a lobe's loss: f is 0 there. rng is a numpy.random.Generator."""
    _, distribution = _c_model(model)
    model = getattr(model, "model", model)
    rng = np.random.default_rng(rng)
    wi = _directions(wi).reshape(3)
    has_kd, has_ks = max(model.kd) > 0, max(model.ks) > 0
    diffuse = has_kd / (has_kd + has_ks) if has_kd or has_ks else 1.0
    spread = rng.random(n) < diffuse
    u = rng.random((n, 2))
    try:
        normals, seen = distribution.sample_visible(wi, u), True
    except UnsupportedError:
        normals, seen = distribution.sample(u), False
    wo = 2 * (normals @ wi)[:, None] * normals - wi
    radius, turn = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    wo[spread] = np.stack((radius * np.cos(turn), radius * np.sin(turn), np.sqrt(1 - u[:, 0])), axis=-1)[spread]
    half = wi + wo
    size = np.linalg.norm(half, axis=-1)
    half *= np.where(half[:, 2] < 0, -1, 1)[:, None] / size[:, None]
    facets = distribution.pdf_visible(wi, half) if seen else distribution.pdf(half)
    return wo, diffuse * np.maximum(wo[:, 2], 0) / np.pi + (1 - diffuse) * facets / (2 * size)


# ---- Measurements and fits ----

class Measurement(_Handle):
    """A measurement: of a file in any format that the program knows, or of an array of the shape (3, 90, 90, n_phi_d) over
    channel, theta_h, theta_d, phi_d, 1/sr; entries that are negative or not finite are masked."""

    def __init__(self, source):
        free = _lib.stdfit_measurement_free
        if isinstance(source, (str, bytes, os.PathLike)):
            self._make("measurement_read", free, _bytes(source))
            return
        values = np.ascontiguousarray(source, dtype=np.float64)
        if values.ndim != 4 or values.shape[:3] != (3, 90, 90):
            raise ValueError(f"expected an array of the shape (3, 90, 90, n_phi_d), found {values.shape}")
        self._make("measurement_from_values", free, values.shape[3], values.ctypes.data)

    @classmethod
    def of_model(cls, model, bins=None, n_phi_d=180):
        """An ideal measurement of a Model or a Fit."""
        struct, distribution = _c_model(model)
        self = cls.__new__(cls)
        self._make("measurement_from_model", _lib.stdfit_measurement_free, ctypes.byref(struct), distribution,
                   _bytes(bins), n_phi_d)
        return self

    @property
    def n_phi_d(self):
        """180 or 360; 0 for samples that lie anywhere."""
        return _lib.stdfit_measurement_n_phi_d(self)

    def values(self, out=None):
        """The values, NaN where masked, of the shape (3, 90, 90, n_phi_d)."""
        out = _result((3, 90, 90, self.n_phi_d), out)
        _call("measurement_values", self, out.ctypes.data)
        return out

    def write(self, path):
        """Writes a MERL file."""
        _call("measurement_write", self, _bytes(path))


def _measurement(source):
    return source if isinstance(source, Measurement) else Measurement(source)


def _c_options(options):
    struct = _lib.stdfit_options_default()
    for name, value in options.items():
        field = name.rstrip("_")  # lambda_
        if field not in _fields("options", but=("trace", "trace_data", "cancel")):
            raise TypeError(f"no option {name}")
        _assign(struct, field, value)
    return struct


def fit_all(source, ndfs="std,ggx,beckmann", progress=None, **options):
    """Fits each distribution of ndfs to a path, an array or a Measurement: a list of Fit. The options are the fields of
    struct stdfit_options of the header (lambda is lambda_). progress(step) is called at each better shape, perhaps from
    another thread; what it raises stops the fit and is raised here. Ctrl-C stops the fit too."""
    measurement = _measurement(source)
    struct = _c_options({"ndfs": ndfs, **options})
    cancel, raised, done = ctypes.c_int(0), [], threading.Event()
    struct.cancel = ctypes.addressof(cancel)

    def trace(_, step):
        try:
            if not cancel.value:
                progress(_from_struct(Step, step.contents))
        except BaseException as error:
            raised.append(error)
            cancel.value = 1

    if progress is not None:
        struct.trace = dict(struct._fields_)["trace"](trace)
    n = (struct.ndfs or b"").count(b",") + 1
    results = (_struct("result") * n)()

    # Python sees Ctrl-C between its own instructions only: so the fit has a thread of its own, and this one waits.
    def work():
        context = ctypes.c_void_p()
        try:
            _call("context_new", ctypes.byref(context), measurement.n_phi_d, ctypes.byref(struct))
            _call("fit", context, measurement, ctypes.byref(struct), n, results)
        except BaseException as error:
            raised.append(error)
        finally:
            _lib.stdfit_context_free(context)
            done.set()

    worker = threading.Thread(target=work, name="stdfit")
    worker.start()
    try:
        while not done.wait(0.2):  # a signal that another thread got does not end the wait
            pass
    finally:
        cancel.value = 1
        worker.join()
    if raised:
        raise raised[0]
    return [_fit_of(result) for result in results]


def fit(source, ndf="std", progress=None, **options):
    """The Fit of one distribution; see fit_all()."""
    fits = fit_all(source, ndf, progress, **options)
    if len(fits) != 1:
        raise DomainError(f"expected one distribution, found {ndf}")
    return fits[0]


def compare(source, model, **options):
    """The Metrics of a Model or a Fit against a path, an array or a Measurement."""
    struct, distribution = _c_model(model)
    metrics, options = _struct("metrics")(), _c_options(options)
    _call("compare", _measurement(source), ctypes.byref(struct), distribution, ctypes.byref(options), ctypes.byref(metrics))
    return _from_struct(Metrics, metrics)
