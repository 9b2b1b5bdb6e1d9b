// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/parameter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "c3de/core/text.h"

namespace c3de {
namespace {

const char *typeName(std::uint32_t type) {
  switch (type) {
    case C3DE_PARAM_F64: return "a number";
    case C3DE_PARAM_I64: return "a whole number";
    case C3DE_PARAM_BOOL: return "true or false";
    case C3DE_PARAM_CHOICE: return "one of the choices";
    case C3DE_PARAM_TEXT: return "text";
    case C3DE_PARAM_VEC3: return "three numbers";
    default: return "a value";
  }
}

std::string unitSuffix(const ParameterDecl &decl) { return decl.unit.empty() ? "" : " " + decl.unit; }

tl::unexpected<Error> refuse(const ParameterDecl &decl, const ParameterValue &value) {
  // Class ids end with a generation after a '/'.
  const bool isClass = decl.type == C3DE_PARAM_CHOICE && value.text.find('/') != std::string::npos;
  return fail(ErrorCode::usage,
              fmt::format("{} = {}{} is not accepted; accepted: {}{}", decl.id, value.display(),
                          value.type == C3DE_PARAM_F64 ? unitSuffix(decl) : "", decl.accepted(),
                          isClass ? "; values from a plugin are available once it is loaded (--plugin)" : ""));
}

bool inRange(const ParameterDecl &decl, double x) {
  const bool aboveMin = (decl.flags & C3DE_PARAM_MIN_OPEN) ? x > decl.min : x >= decl.min;
  const bool belowMax = (decl.flags & C3DE_PARAM_MAX_OPEN) ? x < decl.max : x <= decl.max;
  return aboveMin && belowMax;
}

}  // namespace

c3de_param_value ParameterValue::abi() const {
  c3de_param_value v{};
  v.size = sizeof v;
  v.type = type;
  v.id = toAbi(id);
  v.num = num;
  v.text = toAbi(text);
  for (int i = 0; i < 3; ++i) v.vec[i] = vec[static_cast<std::size_t>(i)];
  return v;
}

ParameterValue ParameterValue::from(const c3de_param_value &value) {
  ParameterValue v;
  v.type = value.type;
  v.id = fromAbi(value.id);
  v.num = value.num;
  v.text = fromAbi(value.text);
  v.vec = {value.vec[0], value.vec[1], value.vec[2]};
  return v;
}

std::string ParameterValue::display() const {
  switch (type) {
    case C3DE_PARAM_BOOL: return num != 0.0 ? "true" : "false";
    case C3DE_PARAM_I64: return fmt::format("{:.0f}", num);
    case C3DE_PARAM_F64: return formatNumber(num);
    case C3DE_PARAM_VEC3: return fmt::format("[{}, {}, {}]", vec[0], vec[1], vec[2]);
    default: return '"' + text + '"';
  }
}

ParameterDecl ParameterDecl::from(const c3de_param_decl &decl) {
  ParameterDecl d;
  d.type = decl.type;
  d.id = fromAbi(decl.id);
  d.label = displayText(fromAbi(decl.label));
  d.unit = displayText(fromAbi(decl.unit));
  d.doc = displayText(fromAbi(decl.doc), Lines::many);
  d.group = displayText(fromAbi(decl.group));
  d.min = decl.min;
  d.max = decl.max;
  d.softMin = decl.soft_min;
  d.softMax = decl.soft_max;
  d.fallback = decl.fallback;
  d.fallbackText = fromAbi(decl.fallback_text);
  d.fallbackVec = {decl.fallback_vec[0], decl.fallback_vec[1], decl.fallback_vec[2]};
  for (std::uint64_t i = 0; i < decl.choices_n; ++i) d.choices.emplace_back(fromAbi(decl.choices[i]));
  d.flags = decl.flags;
  d.alternativeTo = fromAbi(decl.alternative_to);
  return d;
}

ParameterValue ParameterDecl::fallbackValue() const {
  ParameterValue v;
  v.id = id;
  v.type = type;
  v.num = fallback;
  v.text = fallbackText;
  v.vec = fallbackVec;
  if ((flags & C3DE_PARAM_AUTO) && fallbackText == "auto") v.type = C3DE_PARAM_TEXT;
  return v;
}

std::string ParameterDecl::accepted() const {
  std::string text;
  switch (type) {
    case C3DE_PARAM_F64:
    case C3DE_PARAM_I64:
      text = fmt::format("{} {} value {} {}{}", min,
                         (flags & C3DE_PARAM_MIN_OPEN) ? "<" : "<=", (flags & C3DE_PARAM_MAX_OPEN) ? "<" : "<=", max,
                         unitSuffix(*this));
      if (type == C3DE_PARAM_I64) text = "a whole number, " + text;
      break;
    case C3DE_PARAM_CHOICE:
      for (const std::string &choice : choices) text += (text.empty() ? "" : " | ") + choice;
      break;
    case C3DE_PARAM_VEC3: text = fmt::format("three numbers of {} … {}{}", min, max, unitSuffix(*this)); break;
    default: text = typeName(type);
  }
  if (flags & C3DE_PARAM_AUTO) text = "\"auto\" or " + text;
  return text;
}

Expected<void> checkParameter(const ParameterDecl &decl, const ParameterValue &value) {
  if ((decl.flags & C3DE_PARAM_AUTO) && (value.type == C3DE_PARAM_TEXT || value.type == C3DE_PARAM_CHOICE)) {
    if (value.text == "auto") return {};
    return refuse(decl, value);
  }
  const bool isNumber = value.type == C3DE_PARAM_F64 || value.type == C3DE_PARAM_I64;
  switch (decl.type) {
    case C3DE_PARAM_F64:
      // Infinity is allowed where the declared range includes it; a comparison with NaN is false.
      if (!isNumber || !inRange(decl, value.num)) return refuse(decl, value);
      return {};
    case C3DE_PARAM_I64:
      if (!isNumber || !std::isfinite(value.num) || value.num != std::floor(value.num) || !inRange(decl, value.num))
        return refuse(decl, value);
      return {};
    case C3DE_PARAM_BOOL:
      if (value.type != C3DE_PARAM_BOOL) return refuse(decl, value);
      return {};
    case C3DE_PARAM_CHOICE:
      if ((value.type != C3DE_PARAM_CHOICE && value.type != C3DE_PARAM_TEXT) ||
          std::find(decl.choices.begin(), decl.choices.end(), value.text) == decl.choices.end())
        return refuse(decl, value);
      return {};
    case C3DE_PARAM_TEXT:
      if (value.type != C3DE_PARAM_TEXT) return refuse(decl, value);
      return {};
    case C3DE_PARAM_VEC3:
      if (value.type != C3DE_PARAM_VEC3) return refuse(decl, value);
      for (const double x : value.vec)
        if (!std::isfinite(x) || x < decl.min || x > decl.max) return refuse(decl, value);
      return {};
    default: return fail(ErrorCode::internal, fmt::format("{}: declared with unknown type {}", decl.id, decl.type));
  }
}

Expected<const ParameterDecl *> findParameter(const std::vector<ParameterDecl> &decls, std::string_view id) {
  std::vector<std::string> ids;
  for (const ParameterDecl &decl : decls) {
    if (decl.id == id) return &decl;
    ids.push_back(decl.id);
  }
  const std::string nearest = nearestName(id, ids);
  std::string text = fmt::format("unknown key '{}'", id);
  if (!nearest.empty()) {
    text += fmt::format("; did you mean '{}'?", nearest);
  } else {
    text += "; known:";
    for (const std::string &known : ids) text += " " + known;
  }
  return fail(ErrorCode::usage, text);
}

std::vector<ParameterDecl> readDeclarations(const c3de_param_decl *decls, std::uint64_t n, std::uint64_t stride) {
  std::vector<ParameterDecl> out;
  const auto *bytes = reinterpret_cast<const unsigned char *>(decls);
  // 0: contiguous elements, in the size known to the other side.
  const std::uint64_t step = stride != 0 || n == 0 ? stride : decls->size;
  for (std::uint64_t i = 0; i < n; ++i) {
    const unsigned char *row = bytes + i * step;
    c3de_param_decl decl{};
    std::uint32_t size = 0;
    std::memcpy(&size, row, sizeof size);
    std::memcpy(&decl, row, std::min<std::size_t>(size, sizeof decl));
    out.push_back(ParameterDecl::from(decl));
  }
  return out;
}

}  // namespace c3de
