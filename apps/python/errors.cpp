// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/python/errors.hpp"

#include "kernel/scene/scene_error.hpp"

namespace suture::python {
namespace {

namespace py = pybind11;

/// The classes; they live as long as the interpreter.
struct Classes {
  PyObject *error, *input, *scene, *plugin, *numerical, *io;
};
Classes classes{};

PyObject* make(py::module_& module, const char* name, const py::tuple& bases, const char* doc) {
  const std::string full = std::string("suture.") + name;
  PyObject* made = PyErr_NewExceptionWithDoc(full.c_str(), doc, bases.ptr(), nullptr);
  if (made == nullptr) throw py::error_already_set();
  module.add_object(name, made);
  return made;
}

void raise(const SceneError& error) {
  const py::object raised = py::reinterpret_borrow<py::object>(classes.scene)(error.what());
  py::list mistakes;
  for (const SceneMistake& mistake : error.mistakes())
    mistakes.append(py::make_tuple(
        mistake.path, mistake.line > 0 ? py::object(py::int_(mistake.line)) : py::none(),
        mistake.text));
  raised.attr("mistakes") = mistakes;
  PyErr_SetObject(classes.scene, raised.ptr());
}

void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(std::move(thrown));
  } catch (const SceneError& error) {
    raise(error);
  } catch (const PluginError& error) {
    PyErr_SetString(classes.plugin, error.what());
  } catch (const NumericalError& error) {
    PyErr_SetString(classes.numerical, error.what());
  } catch (const IoError& error) {
    PyErr_SetString(classes.io, error.what());
  } catch (const Error& error) {
    PyErr_SetString(classes.input, error.what());
  }
}

}  // namespace

void add_errors(py::module_& module) {
  const auto of = [](auto... bases) {
    return py::make_tuple(py::reinterpret_borrow<py::object>(bases)...);
  };
  classes.error = make(module, "Error", of(PyExc_RuntimeError), "An error of Suture.");
  classes.input = make(module, "InputError", of(classes.error, PyExc_ValueError),
                       "A scene, mesh, event or array that cannot be used; nothing has changed.");
  classes.scene = make(module, "SceneError", of(classes.input),
                       "Mistakes of a scene or an event.\n\n"
                       "mistakes: list of (path, line, text): the JSON pointer of the value, its "
                       "line in the text (None where there is none) and what is wrong with it.");
  py::reinterpret_borrow<py::object>(classes.scene).attr("mistakes") = py::tuple();
  classes.plugin = make(module, "PluginError", of(classes.error), "A plugin at fault.");
  classes.numerical = make(module, "NumericalError", of(classes.error, PyExc_ArithmeticError),
                           "The run cannot go on: values that are not finite, inverted elements, "
                           "no convergence.");
  classes.io = make(module, "IoError", of(classes.error, PyExc_OSError),
                    "A file that cannot be read or written.");
  py::register_exception_translator(translate);
}

}  // namespace suture::python
