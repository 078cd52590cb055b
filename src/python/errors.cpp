#include <exception>

#include "python/python.hpp"

namespace clearway::python {
namespace {

/// The name that Python has as Error.remedy; nullptr where nothing helps.
const char* name_of(Remedy remedy) {
  switch (remedy) {
    case Remedy::kNone:
      return nullptr;
    case Remedy::kMoreMemory:
      return "more_memory";
    case Remedy::kMoreDeviceMemory:
      return "more_device_memory";
    case Remedy::kOtherGpu:
      return "other_gpu";
    case Remedy::kCpuDevice:
      return "cpu_device";
    case Remedy::kNewProcess:
      return "new_process";
    case Remedy::kLessDeviceMemory:
      return "less_device_memory";
    case Remedy::kLessMemory:
      return "less_memory";
    case Remedy::kFewerThreads:
      return "fewer_threads";
    case Remedy::kSweepEngine:
      return "sweep_engine";
    case Remedy::kCudaDevice:
      return "cuda_device";
    case Remedy::kMoreCellPoints:
      return "more_cell_points";
    case Remedy::kFewerCellPoints:
      return "fewer_cell_points";
    case Remedy::kScale:
      return "scale";
    case Remedy::kOneScale:
      return "one_scale";
    case Remedy::kAcceptScale:
      return "accept_scale";
    case Remedy::kColumns:
      return "columns";
    case Remedy::kStandardInput:
      return "standard_input";
    case Remedy::kSampleMesh:
      return "sample_mesh";
    case Remedy::kSkipUnreadable:
      return "skip_unreadable";
    case Remedy::kIgnoreCrs:
      return "ignore_crs";
    case Remedy::kOverwrite:
      return "overwrite";
    case Remedy::kReadOrOverwrite:
      return "read_or_overwrite";
    case Remedy::kResumeOrOverwrite:
      return "resume_or_overwrite";
    case Remedy::kOverwriteNotResume:
      return "overwrite_not_resume";
    case Remedy::kRestoreOptions:
      return "restore_options";
    case Remedy::kNameFormat:
      return "name_format";
    case Remedy::kNameCrs:
      return "name_crs";
    case Remedy::kDeclareAngles:
      return "declare_angles";
    case Remedy::kDeclareLength:
      return "declare_length";
    case Remedy::kAllowNonRigid:
      return "allow_non_rigid";
    case Remedy::kGiveHeight:
      return "give_height";
    case Remedy::kRoundCorners:
      return "round_corners";
    case Remedy::kAskForClearance:
      return "ask_for_clearance";
    case Remedy::kAskForFirstPose:
      return "ask_for_first_pose";
    case Remedy::kSameTrajectory:
      return "same_trajectory";
    case Remedy::kSameModel:
      return "same_model";
    case Remedy::kSameEnvironment:
      return "same_environment";
    case Remedy::kAskForProfile:
      return "ask_for_profile";
    case Remedy::kModelSpacing:
      return "model_spacing";
    case Remedy::kModelPoints:
      return "model_points";
    case Remedy::kMerge:
      return "merge";
    case Remedy::kFreeDisk:
      return "free_disk";
    case Remedy::kOtherPart:
      return "other_part";
    case Remedy::kResume:
      return "resume";
  }
  return nullptr;
}

/// The exception classes, which live as long as the process.
struct Classes {
  PyObject *error, *usage, *input, *resource, *interrupted;
};
Classes error_classes{};

PyObject* add_class(py::module_& module, const char* name, const char* doc, py::tuple bases) {
  PyObject* made = PyErr_NewExceptionWithDoc((std::string("clearway.") + name).c_str(), doc,
                                             bases.ptr(), nullptr);
  if (made == nullptr) throw py::error_already_set();
  module.attr(name) = py::handle(made);
  return made;
}

void raise(PyObject* type, const Error& error) {
  const py::object raised = py::handle(type)(text(error.what()));
  if (const char* remedy = name_of(error.remedy())) raised.attr("remedy") = remedy;
  raised.attr("amount") = error.amount();
  PyErr_SetObject(type, raised.ptr());
}

void translate(std::exception_ptr thrown) {  // NOLINT(performance-unnecessary-value-param)
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const UsageError& error) {
    raise(error_classes.usage, error);
  } catch (const InputError& error) {
    raise(error_classes.input, error);
  } catch (const ResourceError& error) {
    raise(error_classes.resource, error);
  } catch (const Interrupted& error) {
    raise(error_classes.interrupted, error);
  } catch (const Error& error) {
    raise(error_classes.error, error);
  }
}

}  // namespace

void add_errors(py::module_& module) {
  const py::handle plain = PyExc_Exception, value = PyExc_ValueError;
  error_classes.error = add_class(
      module, "Error",
      "Raised where a call cannot be done. The text says what happened and where.\n\n"
      "remedy: what would help, such as 'overwrite' or 'more_memory'; None where nothing is "
      "known.\n"
      "amount: the number of the remedy, such as the bytes that are enough; 0 where it has none.",
      py::make_tuple(plain));
  const py::handle error = error_classes.error;
  error.attr("remedy") = py::none();
  error.attr("amount") = 0.0;
  error_classes.usage =
      add_class(module, "UsageError",
                "Raised for arguments that contradict each other, or ask for what cannot be done.",
                py::make_tuple(error, value));
  error_classes.input = add_class(
      module, "InputError", "Raised for an input that is malformed, damaged or not supported.",
      py::make_tuple(error));
  error_classes.resource =
      add_class(module, "ResourceError",
                "Raised where a file cannot be read or written, or memory or a GPU is missing.",
                py::make_tuple(error));
  error_classes.interrupted = add_class(
      module, "Interrupted",
      "Raised where a call was stopped on request. Nothing that was found is lost: the same "
      "search with resume=True goes on.",
      py::make_tuple(error));
  py::register_local_exception_translator(translate);
}

}  // namespace clearway::python
