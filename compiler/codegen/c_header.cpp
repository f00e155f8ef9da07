#include "compiler/codegen/c_header.h"

#include "runtime/abi/tf_model.h"

#include <fmt/format.h>

#include <cctype>
#include <set>

namespace tf {

namespace {

// "der(q[2])" becomes "der_q_2".
std::string identifier(const std::string &name) {
  std::string text;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      text += c;
    else if (!text.empty() && text.back() != '_')
      text += '_';
  }
  while (!text.empty() && text.back() == '_')
    text.pop_back();
  return text.empty() ? "model" : text;
}

std::string upper(std::string text) {
  for (char &c : text)
    c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

// In a comment on one line.
std::string comment(std::string text) {
  for (char &c : text)
    if (c == '\n' || c == '*')
      c = ' ';
  return text;
}

class HeaderWriter {
public:
  explicit HeaderWriter(std::string prefix) : prefix_(std::move(prefix)) {}

  void open(const std::string &what) {
    used_.clear();
    text_ += fmt::format("/* {} */\nenum {{\n", what);
    empty_ = true;
  }

  void constant(const std::string &group, const std::string &name, int value, const std::string &remark) {
    std::string full = fmt::format("{}_{}{}", prefix_, group, identifier(name));
    for (int k = 2; !used_.insert(full).second; ++k)
      full = fmt::format("{}_{}{}_{}", prefix_, group, identifier(name), k);
    text_ += fmt::format("  {} = {},{}\n", full, value, remark.empty() ? "" : fmt::format(" /* {} */", comment(remark)));
    empty_ = false;
  }

  // An enumeration may not be empty in C.
  void close(const std::string &what) {
    if (empty_)
      text_.resize(text_.size() - fmt::format("/* {} */\nenum {{\n", what).size());
    else
      text_ += "};\n\n";
  }

  template <class Body> void enumeration(const std::string &what, const Body &body) {
    open(what);
    body();
    close(what);
  }

  std::string text_;

private:
  std::string prefix_;
  std::set<std::string> used_;
  bool empty_ = true;
};

std::string remarkOf(const Quantity &quantity) {
  std::string remark = quantity.name;
  if (!quantity.unit.empty())
    remark += fmt::format(" [{}]", quantity.unit);
  if (!quantity.description.empty())
    remark += ": " + quantity.description;
  return remark;
}

bool isArgument(int kind) {
  return kind == TF_KIND_COORDINATE || kind == TF_KIND_VELOCITY || kind == TF_KIND_STATE || kind == TF_KIND_INPUT ||
         kind == TF_KIND_PARAMETER;
}

const char *groupOf(int kind) {
  switch (kind) {
  case TF_KIND_COORDINATE:
    return "q_";
  case TF_KIND_VELOCITY:
    return "v_";
  case TF_KIND_STATE:
    return "z_";
  case TF_KIND_INPUT:
    return "u_";
  default:
    return "p_";
  }
}

}  // namespace

std::string emitHeader(const HybridSystem &system) {
  const std::string prefix = identifier(system.name);
  const std::string guard = upper(prefix) + "_TF_MODEL_H";
  HeaderWriter writer(prefix);
  writer.text_ =
      fmt::format("/* Model {}{}{}. Made by tfc. */\n#ifndef {}\n#define {}\n\n#include \"runtime/abi/tf_model.h\"\n\n#ifdef __cplusplus\n"
                  "extern \"C\" {{\n#endif\n\nextern const tf_model {};\n\n",
                  system.name, system.description.empty() ? "" : ": ", comment(system.description), guard, guard, TF_MODEL_SYMBOL);
  writer.enumeration("Numbers of elements.", [&] {
    const std::pair<const char *, std::size_t> counts[] = {{"coordinates", static_cast<std::size_t>(system.nq)},
                                                           {"velocities", static_cast<std::size_t>(system.nv)},
                                                           {"states", static_cast<std::size_t>(system.nz)},
                                                           {"inputs", static_cast<std::size_t>(system.nu)},
                                                           {"parameters", static_cast<std::size_t>(system.np)},
                                                           {"contacts", system.contacts.size()},
                                                           {"tangents", system.tangents.size()},
                                                           {"frictions", system.frictions.size()},
                                                           {"constraints", system.constraints.size()},
                                                           {"multipliers", system.constraintRows.size()},
                                                           {"switches", system.switches.size()},
                                                           {"outputs", system.outputs.size()},
                                                           {"variables", system.quantities.size()}};
    for (const auto &[name, count] : counts)
      writer.constant("count_", name, static_cast<int>(count), "");
  });
  writer.enumeration("Places in the model's table of variables, which are those of the result columns.", [&] {
    for (std::size_t k = 0; k < system.quantities.size(); ++k)
      writer.constant("", system.quantities[k].name, static_cast<int>(k), remarkOf(system.quantities[k]));
    for (const Alias &alias : system.aliases)
      writer.constant("", alias.name, alias.quantity, alias.sign < 0 ? alias.name + ", with the opposite sign" : alias.name);
  });
  writer.enumeration("Places in the arguments q, v, z, u and p of the generated functions.", [&] {
    for (const Quantity &quantity : system.quantities)
      if (isArgument(quantity.kind))
        writer.constant(groupOf(quantity.kind), quantity.name, quantity.index, "");
  });
  writer.enumeration("Contacts, friction elements, constraints and switches.", [&] {
    for (std::size_t k = 0; k < system.contacts.size(); ++k)
      writer.constant("contact_", system.contacts[k].name, static_cast<int>(k), "");
    for (std::size_t k = 0; k < system.frictions.size(); ++k)
      writer.constant("friction_", system.frictions[k].name, static_cast<int>(k), "");
    for (std::size_t k = 0; k < system.constraints.size(); ++k)
      writer.constant("constraint_", system.constraints[k].name, static_cast<int>(k), "");
    for (std::size_t k = 0; k < system.switches.size(); ++k)
      writer.constant("switch_", std::to_string(k + 1), static_cast<int>(k), system.switches[k].text);
  });
  writer.text_ += "#ifdef __cplusplus\n}\n#endif\n\n#endif\n";
  return writer.text_;
}

}  // namespace tf
