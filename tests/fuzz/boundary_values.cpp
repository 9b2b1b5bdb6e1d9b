// SPDX-License-Identifier: Apache-2.0
#include "boundary_values.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace fuzz {
namespace {

std::uint64_t doNothing() { return 0; }

c3de_status C3DE_CALL swallow(void *, const void *, std::uint64_t) { return C3DE_OK; }

std::uint32_t C3DE_CALL countOne(c3de_object *) { return 1; }
c3de_status C3DE_CALL answerNothing(c3de_object *, c3de_str, std::uint32_t, const void **) { return C3DE_E_NOT_FOUND; }
constexpr c3de_object_vt kVt{sizeof(c3de_object_vt), 1, countOne, countOne, answerNothing};
c3de_object objectOfNobody{&kVt};

bool beginsWith(const std::string &text, const char *with) { return text.rfind(with, 0) == 0; }

}  // namespace

BoundaryValues::BoundaryValues(std::uint64_t seed) : engine_(seed) {
  std::ifstream file(C3DE_GOLDEN);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string state, name;
    std::size_t first = 0, second = 0;
    words >> state >> name >> first;
    const auto dot = name.find('.');
    if (dot == std::string::npos) {
      types_[name].size = first;
      continue;
    }
    std::string type;
    words >> second;
    std::getline(words, type);
    if (dot + 1 < name.size())
      types_[name.substr(0, dot)].members.push_back({name.substr(dot + 1), type.substr(1), first, second});
  }
  if (types_.empty()) throw std::runtime_error("no list of the boundary: " C3DE_GOLDEN);
  for (const char *text : {"", "a", "test.fuzz.A", "c3de.log/1", "world.gravity", "\xff\xfe", "\x1b[2J", "%s%n%n",
                           "../../x", "\xe2\x80\xae", "mm"})
    texts_.emplace_back(text);
  texts_.emplace_back(100000, 'x');
  texts_.emplace_back(3, '\0');
  handles_ = {{0}, {1}, {~std::uint64_t{0}}, {0x0001000100000001u}};
}

std::uint32_t BoundaryValues::u32() {
  constexpr std::array<std::uint32_t, 10> kValues{0, 1, 2, 3, 4, 7, 64, 0x7fffffffu, 0x80000000u, 0xffffffffu};
  return chance(3) ? kValues[below(kValues.size())] : static_cast<std::uint32_t>(below(8));
}

std::uint64_t BoundaryValues::u64() {
  constexpr std::array<std::uint64_t, 5> kValues{0, 1, std::uint64_t{1} << 40, std::uint64_t{1} << 63,
                                                 ~std::uint64_t{0}};
  return chance(4) ? kValues[below(kValues.size())] : below(kArray + 1);
}

double BoundaryValues::real() {
  using Limits = std::numeric_limits<double>;
  constexpr std::array kValues{0.0,
                               -0.0,
                               1.0,
                               -1.0,
                               1e-300,
                               1e300,
                               -1e300,
                               0.5,
                               1e9,
                               Limits::denorm_min(),
                               Limits::infinity(),
                               -Limits::infinity(),
                               Limits::quiet_NaN()};
  return chance(3) ? kValues[below(kValues.size())] : static_cast<double>(engine_() >> 11) * 0x1p-52 - 1.0;
}

c3de_str BoundaryValues::text() {
  if (chance(20)) return {nullptr, below(3)};  // also null with a length
  const std::string &chosen = texts_[below(texts_.size())];
  return {chosen.data(), chosen.size()};
}

c3de_handle BoundaryValues::handle() {
  if (chance(8)) return {engine_()};
  if (!keptHandles_.empty() && chance(2)) return keptHandles_[below(keptHandles_.size())];
  return handles_[below(handles_.size())];
}

void BoundaryValues::remember(c3de_handle handle) {
  if (handle.v == 0) return;
  if (handles_.size() > 64) handles_.erase(handles_.begin() + static_cast<std::ptrdiff_t>(below(handles_.size())));
  handles_.push_back(handle);
}

void *BoundaryValues::reals(std::size_t size) {
  auto *at = static_cast<unsigned char *>(memory(kMemory));
  const bool isTame = !chance(4);
  for (std::size_t i = 0; i < 64; ++i) {
    const double value = isTame ? static_cast<double>(below(2000)) / 1000.0 - 1.0 : real();
    const auto narrow = static_cast<float>(value);
    if (size == sizeof value)
      std::memcpy(at + i * size, &value, size);
    else
      std::memcpy(at + i * size, &narrow, size);
  }
  return at;
}

c3de_view BoundaryValues::view() {
  constexpr std::array<std::uint32_t, 3> kKnown{C3DE_F64, C3DE_F32, C3DE_U32};
  // The usual case of most functions: tightly packed rows of three.
  if (chance(2)) {
    if (chance(3)) {
      auto *indices = static_cast<std::uint32_t *>(memory(kMemory));
      for (std::size_t i = 0; i < 36; ++i) indices[i] = static_cast<std::uint32_t>((i / 3 + i % 3) % 4);
      return {indices, 1 + below(4), 3, C3DE_U32, 0};
    }
    return {reals(areDouble_ ? sizeof(double) : sizeof(float)), rows_, 3, areDouble_ ? C3DE_F64 : C3DE_F32, 0};
  }
  const std::uint32_t type = chance(10) ? u32() : kKnown[below(kKnown.size())];
  const std::uint32_t comps = chance(10) ? u32() : static_cast<std::uint32_t>(1 + below(4));
  const std::uint64_t count = chance(10) ? u64() : below(kMaxRows);
  // Its readable memory: within reach of all small counts and widths.
  auto *data = static_cast<unsigned char *>(type == C3DE_F32 ? reals(sizeof(float)) : reals(sizeof(double)));
  if (type == C3DE_U32)
    for (std::size_t i = 0; i < 256; ++i) {
      const auto index = static_cast<std::uint32_t>(chance(40) ? engine_() : below(10));
      std::memcpy(data + 4 * i, &index, 4);
    }
  std::int64_t stride = 0;
  if (chance(6)) stride = chance(2) ? -static_cast<std::int64_t>(below(64)) : static_cast<std::int64_t>(below(64));
  if (chance(12)) return {nullptr, count, comps, type, stride};
  if (chance(20)) ++data;  // not aligned
  return {data, count, comps, type, stride};
}

c3de_sink BoundaryValues::sink() {
  c3de_sink sink{};
  static_assert(sizeof sink == 2 * sizeof(void *));
  if (chance(10)) return sink;
  void *const function = reinterpret_cast<void *>(&swallow);
  std::memcpy(reinterpret_cast<unsigned char *>(&sink) + sizeof(void *), &function, sizeof function);
  return sink;
}

void *BoundaryValues::nothing() { return reinterpret_cast<void *>(&doNothing); }

c3de_object *BoundaryValues::object() { return &objectOfNobody; }

void *BoundaryValues::memory(std::size_t bytes) {
  kept_.emplace_back((bytes + 7) / 8 + 1);
  return kept_.back().data();
}

std::size_t BoundaryValues::sizeOf(std::string_view name) const {
  const auto found = types_.find(name);
  return found == types_.end() ? 0 : found->second.size;
}

void *BoundaryValues::structs(std::string_view name, std::size_t n, int depth) {
  const auto found = types_.find(name);
  if (found == types_.end()) return memory(kMemory);
  auto *at = static_cast<unsigned char *>(memory(n * found->second.size));
  for (std::size_t i = 0; i < n; ++i) fill(at + i * found->second.size, found->second, depth);
  return at;
}

void BoundaryValues::fill(unsigned char *at, const Struct &type, int depth) {
  for (const Member &member : type.members) fill(at, member, depth);
  // Lengths of arrays: the actual ones, or impossibly large ones.
  const auto set = [&](const Member &member, std::uint64_t value) {
    std::memcpy(at + member.offset, &value, member.size);
  };
  for (const Member &member : type.members) {
    const std::string &name = member.name;
    if (name == "size" && member.offset == 0) {
      constexpr std::array<std::uint64_t, 4> kWrong{0, 4, 8, 0x80000000u};
      set(member, chance(12) ? kWrong[below(kWrong.size())] : type.size);
    }
    if (name == "rev" && !chance(12)) set(member, 1);
    const auto ending = name.rfind("_n");
    if (ending != std::string::npos && ending + 2 == name.size())
      set(member, chance(10) ? std::uint64_t{1} << 62 : below(kArray + 1));
    const auto stride = name.rfind("_stride");
    if (stride == std::string::npos) continue;
    // Of the array whose name precedes it; 0 and less than a row must be detected, more than a row cannot be.
    std::size_t row = 0;
    for (const Member &array : type.members)
      if (array.name == name.substr(0, stride)) {
        std::istringstream words(array.type);
        for (std::string word; words >> word;)
          if (sizeOf(word) > 0) row = sizeOf(word);
      }
    set(member, chance(8) ? below(4) : row);
  }
}

void BoundaryValues::fill(unsigned char *at, const Member &member, int depth) {
  unsigned char *place = at + member.offset;
  const auto put = [&](const auto &value) { std::memcpy(place, &value, std::min(sizeof value, member.size)); };
  const std::string &type = member.type;
  if (type.find("C3DE_CALL") != std::string::npos) return put(chance(12) ? nullptr : nothing());
  if (type.find('*') != std::string::npos) {
    void *pointer = nullptr;
    if (!chance(6) && depth < 3) {
      std::string name = beginsWith(type, "const ") ? type.substr(6) : type;
      if (beginsWith(name, "struct ")) name = name.substr(7);
      name = name.substr(0, name.find_first_of(" *"));
      if (name == "c3de_object")
        pointer = object();
      else if (name == "c3de_str") {
        auto *texts = static_cast<c3de_str *>(memory(kArray * sizeof(c3de_str)));
        for (std::size_t i = 0; i < kArray; ++i) texts[i] = text();
        pointer = texts;
      } else if (sizeOf(name) > 0)
        pointer = structs(name, kArray, depth + 1);
      else
        pointer = reals(name == "float" ? sizeof(float) : sizeof(double));
    }
    return put(pointer);
  }
  if (beginsWith(type, "c3de_str ")) return put(text());
  if (beginsWith(type, "c3de_handle ")) return put(handle());
  if (beginsWith(type, "c3de_view ") || beginsWith(type, "c3de_mview ")) return put(view());
  if (beginsWith(type, "c3de_sink ")) return put(sink());
  if (beginsWith(type, "double "))
    for (std::size_t i = 0; i + sizeof(double) <= member.size; i += sizeof(double)) {
      const double value = real();
      std::memcpy(place + i, &value, sizeof value);
    }
  else if (beginsWith(type, "float "))
    for (std::size_t i = 0; i + sizeof(float) <= member.size; i += sizeof(float)) {
      const auto value = static_cast<float>(real());
      std::memcpy(place + i, &value, sizeof value);
    }
  else if (member.size == sizeof(std::uint64_t))
    put(u64());
  else if (member.size == sizeof(std::uint32_t))
    put(u32());
}

}  // namespace fuzz
