#include "python/python.hpp"

namespace {

using namespace clearway::python;

PYBIND11_MODULE(_clearway, module) {
  py::options shown;
  shown.disable_function_signatures();  // docstrings begin with their own
  module.doc() = "The compiled part of clearway.";
  module.attr("__version__") = CLEARWAY_VERSION;
  add_watch();
  add_errors(module);
  add_values(module);
  add_model(module);
  add_store(module);
  add_inputs(module);
  add_bodies(module);
  add_search(module);
  add_results(module);
  add_findings(module);
  add_section(module);
}

}  // namespace
