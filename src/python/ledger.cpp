#include "clearway/ledger.hpp"

#include <pybind11/stl.h>

#include <limits>
#include <string>
#include <vector>

#include "core/describe/ledger.hpp"
#include "python/arrays.hpp"
#include "python/fields.hpp"
#include "python/findings.hpp"

namespace clearway::python {
namespace {

void add_rows(py::module_& module) {
  py::class_<LedgerRow> row(module, "LedgerRow", "A row of a ledger.");
  add_properties(row, kLedgerRowColumns);
  row.def("__repr__",
          [](const LedgerRow& r) { return text("<row " + r.key + ": " + name_of(r.shown) + ">"); });
  py::class_<LedgerEntry> entry(module, "LedgerEntry", "What a ledger says of a conflict.");
  add_properties(entry, kLedgerEntryColumns);
  entry.def("__repr__", [](const LedgerEntry& e) {
    return text("<conflict " + std::to_string(e.conflict) + ": " + name_of(e.status) + ">");
  });
  py::class_<OutsideOfAccepted>(module, "OutsideOfAccepted",
                                "What is left of an answer without the accepted conflicts.")
      .def_property_readonly(
          "verdict", [](const OutsideOfAccepted& out) { return text(name_of(out.verdict)); },
          "'conflict' where a colliding point is left, of a small group too; otherwise what the "
          "verdict would be if the points of accepted conflicts were not there.")
      .def_readonly("colliding_points", &OutsideOfAccepted::colliding,
                    "How many colliding points are in no accepted conflict.")
      .def_readonly("near_points", &OutsideOfAccepted::near,
                    "How many near points are in no accepted conflict.");
}

py::dict counts_of(const Ledger& ledger) {
  py::dict out;
  const LedgerCounts counts = ledger.counts();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    out[name_of(static_cast<LedgerStatus>(i))] = counts[i];
  }
  return out;
}

/// The rows column by column: texts as lists, and the middle and the size of the box as arrays, in
/// which a row without places has NaN.
py::dict columns_of(const Ledger& ledger) {
  py::dict out;
  for_each_field(kLedgerRowColumns, [&](const auto& column) {
    using Value = typename std::decay_t<decltype(column)>::Value;
    if constexpr (std::is_same_v<Value, std::optional<Box>>) {
      for (const bool is_size : {false, true}) {
        for (int k = 0; k < 3; ++k) {
          std::vector<double> values;
          for (const LedgerRow& row : ledger.rows) {
            const auto& box = column.of(row);
            values.push_back(!box      ? std::numeric_limits<double>::quiet_NaN()
                             : is_size ? box->size()[k]
                                       : box->centre()[k]);
          }
          const std::string axis(1, "xyz"[k]);
          out[py::str(is_size ? "size_" + axis : axis)] = to_array(std::move(values));
        }
      }
    } else {
      py::list values;
      for (const LedgerRow& row : ledger.rows) {
        if constexpr (std::is_enum_v<Value>) {
          values.append(name_of(column.of(row)));
        } else {
          values.append(column.of(row));
        }
      }
      out[column.key] = values;
    }
  });
  return out;
}

}  // namespace

void add_ledger(py::module_& module) {
  add_rows(module);
  py::class_<Ledger>(module, "Ledger", "A ledger of conflicts after it was compared with a result.")
      .def_readonly("rows", &Ledger::rows,
                    "The rows: a list of LedgerRow in the order of the table; those that an update "
                    "adds come last.")
      .def_readonly("conflicts", &Ledger::conflicts,
                    "A list of LedgerEntry, one for each listed conflict, in their order.")
      .def_readonly("date", &Ledger::date, "The day of the run, such as '2026-06-30'.")
      .def_readonly("is_updated", &Ledger::is_updated, "Whether the files were updated.")
      .def_readonly("outside", &Ledger::outside,
                    "What is left without the accepted conflicts: an OutsideOfAccepted.")
      .def_property_readonly("accepted_conflicts", &Ledger::accepted_conflicts,
                             "How many conflicts are accepted.")
      .def("counts", &counts_of, R"(counts(self)
--

The number of rows, and of conflicts without a row, by status: a dict.)")
      .def("columns", &columns_of, R"(columns(self)
--

The rows as a dict of columns, which pandas.DataFrame() takes.

Texts are lists of str, and `conflicts` a list of lists; `x` to `z` and `size_x` to `size_z` are
arrays of float64, NaN where the ledger does not have the places of a row.)")
      .def("__len__", [](const Ledger& ledger) { return ledger.rows.size(); })
      .def("__repr__", [](const Ledger& ledger) {
        return text("<a ledger of " + std::to_string(ledger.rows.size()) + " rows>");
      });
  add_checks(module, "find_conflicts", kLedgerFields);
  add_checks(module, "find_conflicts", kLedgerUpdateFields);
}

}  // namespace clearway::python
