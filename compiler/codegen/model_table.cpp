#include "compiler/codegen/model_table.h"

#include "compiler/codegen/model_facts.h"
#include "runtime/abi/tf_model.h"

#include <llvm/IR/Constants.h>
#include <llvm/IR/DerivedTypes.h>

#include <array>
#include <cassert>
#include <cstddef>
#include <limits>
#include <unordered_map>
#include <vector>

namespace tf::codegen {

namespace {

using Constants = std::vector<llvm::Constant *>;

// Constants as a C compiler lays them out: fields in order at their natural alignment, which LLVM's unpacked structures share.
class TableBuilder {
public:
  TableBuilder(const SourceManager &sources, llvm::Module &module) : sources_(sources), module_(module), context_(module.getContext()) {}

  llvm::Constant *integer(int value) { return llvm::ConstantInt::getSigned(llvm::Type::getInt32Ty(context_), value); }
  llvm::Constant *size(std::size_t value) { return integer(static_cast<int>(value)); }
  llvm::Constant *number(double value) { return llvm::ConstantFP::get(llvm::Type::getDoubleTy(context_), value); }
  llvm::Constant *null() { return llvm::ConstantPointerNull::get(llvm::PointerType::getUnqual(context_)); }

  llvm::Constant *text(const std::string &value) {
    llvm::GlobalVariable *&global = texts_[value];
    if (global == nullptr)
      global = add(llvm::ConstantDataArray::getString(context_, value), "text", llvm::Align(1));
    return global;
  }

  llvm::Constant *structure(const Constants &fields) { return llvm::ConstantStruct::getAnon(context_, fields); }

  llvm::Constant *location(Span span) {
    if (!span.valid())
      return structure({text(""), integer(0), integer(0)});
    const SourceFile &file = sources_.file(span.file);
    const LineColumn place = file.lineColumn(span.begin);
    return structure({text(file.path()), integer(place.line), integer(place.column)});
  }

  // A pointer to the rows; null if there are none.
  llvm::Constant *table(const Constants &rows, const char *name) {
    if (rows.empty())
      return null();
    return add(llvm::ConstantArray::get(llvm::ArrayType::get(rows.front()->getType(), rows.size()), rows), name, llvm::Align(8));
  }

  llvm::GlobalVariable *add(llvm::Constant *value, const char *name, llvm::Align alignment) {
    auto *global = new llvm::GlobalVariable(module_, value->getType(), true, llvm::GlobalValue::PrivateLinkage, value, name);
    global->setAlignment(alignment);
    global->setUnnamedAddr(llvm::GlobalValue::UnnamedAddr::Global);
    return global;
  }

private:
  const SourceManager &sources_;
  llvm::Module &module_;
  llvm::LLVMContext &context_;
  std::unordered_map<std::string, llvm::GlobalVariable *> texts_;
};

llvm::Constant *variables(const HybridSystem &system, TableBuilder &build) {
  Constants rows;
  for (const Quantity &quantity : system.quantities)
    rows.push_back(build.structure({build.text(quantity.name), build.text(quantity.unit), build.text(quantity.description),
                                    build.integer(quantity.kind), build.integer(quantity.index), build.integer(quantity.flags),
                                    build.number(quantity.min), build.number(quantity.max), build.number(quantity.nominal),
                                    build.location(quantity.span)}));
  return build.table(rows, "variables");
}

llvm::Constant *aliases(const HybridSystem &system, TableBuilder &build) {
  Constants rows;
  for (const Alias &alias : system.aliases)
    rows.push_back(
        build.structure({build.text(alias.name), build.text(alias.description), build.integer(alias.quantity), build.number(alias.sign)}));
  return build.table(rows, "aliases");
}

llvm::Constant *contacts(const HybridSystem &system, TableBuilder &build) {
  const std::vector<bool> areAffine = affineGaps(system);
  Constants rows;
  for (const Contact &contact : system.contacts)
    rows.push_back(build.structure({build.text(contact.name), build.integer(contact.tangentFirst), build.integer(contact.tangentCount),
                                    build.integer(contact.frictionForm), build.integer(contact.law), build.number(contact.nominal),
                                    build.location(contact.span), build.integer(frictionVaries(system, contact) ? 1 : 0),
                                    build.integer(areAffine[rows.size()] ? 1 : 0)}));
  return build.table(rows, "contacts");
}

llvm::Constant *frictions(const HybridSystem &system, TableBuilder &build) {
  Constants rows;
  for (const FrictionElement &friction : system.frictions)
    rows.push_back(build.structure({build.text(friction.name), build.integer(friction.tangentFirst), build.integer(friction.tangentCount),
                                    build.integer(friction.frictionForm), build.location(friction.span),
                                    build.integer(dependsOnVelocity(system, friction) ? 1 : 0)}));
  return build.table(rows, "frictions");
}

llvm::Constant *constraints(const HybridSystem &system, TableBuilder &build) {
  Constants rows;
  for (const Constraint &constraint : system.constraints)
    rows.push_back(build.structure({build.text(constraint.name), build.integer(constraint.rowFirst), build.integer(constraint.rowCount),
                                    build.integer(constraint.isHolonomic ? 1 : 0), build.number(constraint.nominal),
                                    build.location(constraint.span)}));
  return build.table(rows, "constraints");
}

llvm::Constant *quaternions(const HybridSystem &system, TableBuilder &build) {
  Constants rows;
  for (const equations::RotationCoordinate &rotation : system.motion.rotations())
    rows.push_back(build.integer(rotation.coordinate));
  return build.table(rows, "quaternions");
}

llvm::Constant *switches(const HybridSystem &system, TableBuilder &build) {
  Constants rows;
  for (const SwitchingFunction &entry : system.switches)
    rows.push_back(build.structure({build.text(entry.text), build.integer(entry.kind), build.integer(entry.zeroIsPositive ? 1 : 0),
                                    build.location(entry.span), build.integer(entry.of)}));
  return build.table(rows, "switches");
}

llvm::Constant *parameters(const HybridSystem &system, TableBuilder &build) {
  Constants values;
  for (std::size_t p = 0; p < system.parameterValues.size(); ++p)
    values.push_back(build.number(p < system.parameterBindings.size() && system.parameterBindings[p] >= 0 ? 0 : system.parameterValues[p]));
  return build.table(values, "parameters");
}

// Rows and columns; null where M is full.
std::array<llvm::Constant *, 2> massTables(const HybridSystem &system, TableBuilder &build) {
  const MassStructure structure = massStructure(system);
  if (structure.isFull())
    return {build.null(), build.null()};
  Constants rows, columns;
  for (const int begin : structure.rows)
    rows.push_back(build.integer(begin));
  for (const int column : structure.columns)
    columns.push_back(build.integer(column));
  return {build.table(rows, "mass_rows"), build.table(columns, "mass_columns")};
}

// Null where nothing varies.
llvm::Constant *variationTable(const HybridSystem &system, TableBuilder &build) {
  Constants entries;
  for (const int bits : variation(system))
    entries.push_back(build.integer(bits));
  return entries.empty() ? build.null() : build.table(entries, "variation");
}

llvm::Constant *given(const std::optional<double> &value, TableBuilder &build) {
  return build.number(value.value_or(std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace

// Field by field in the order of the declaration in runtime/abi/tf_model.h.
void emitModelTable(const HybridSystem &system, const SourceManager &sources, const std::string &hash,
                    std::span<llvm::Function *const> functions, llvm::Module &module) {
  assert(functions.size() == modelFunctionCount);
  TableBuilder build(sources, module);
  Constants fields{build.integer(static_cast<int>(TF_MAGIC)),
                   build.integer(static_cast<int>(TF_ABI_VERSION)),
                   build.text(system.name),
                   build.text(system.description),
                   build.text("tfc " TFC_VERSION),
                   build.text(hash)};
  for (const int count : {system.nq, system.nv, system.nz, system.nu, system.np})
    fields.push_back(build.integer(count));
  for (const std::size_t count : {system.contacts.size(), system.tangents.size(), system.switches.size(), system.outputs.size(),
                                  system.frictions.size(), system.motion.rotations().size(), system.constraints.size(),
                                  system.constraintRows.size(), system.quantities.size(), system.aliases.size()})
    fields.push_back(build.size(count));
  for (llvm::Constant *table : {variables(system, build), aliases(system, build), contacts(system, build), frictions(system, build),
                                switches(system, build), constraints(system, build), quaternions(system, build), parameters(system, build)})
    fields.push_back(table);
  fields.push_back(build.integer(bindingDepth(system)));
  fields.push_back(build.integer(massIsConstant(system) ? 1 : 0));
  fields.push_back(build.integer(system.massProduct.empty() ? 0 : 1));
  fields.push_back(build.integer(locality(system)));
  fields.push_back(build.integer(flightIsUniform(system) ? 1 : 0));
  for (llvm::Constant *table : massTables(system, build))
    fields.push_back(table);
  fields.push_back(variationTable(system, build));
  const flat::Experiment &experiment = system.experiment;
  for (const auto &value : {experiment.startTime, experiment.stopTime, experiment.tolerance, experiment.interval})
    fields.push_back(given(value, build));
  for (llvm::Function *function : functions)
    fields.push_back(function != nullptr ? static_cast<llvm::Constant *>(function) : build.null());
  llvm::Constant *value = build.structure(fields);
  assert(module.getDataLayout().getTypeAllocSize(value->getType()) == sizeof(tf_model));
  auto *global = new llvm::GlobalVariable(module, value->getType(), true, llvm::GlobalValue::ExternalLinkage, value, TF_MODEL_SYMBOL);
  global->setAlignment(llvm::Align(8));
}

}  // namespace tf::codegen
