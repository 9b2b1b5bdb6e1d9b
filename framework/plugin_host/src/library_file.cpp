// SPDX-License-Identifier: Apache-2.0
#include "library_file.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string_view>
#include <vector>

#include "c3de/core/platform.h"

namespace c3de::plugin_host {
namespace {

tl::unexpected<Error> notAPlugin(const std::string &why) { return fail(ErrorCode::plugin, "not a plugin: " + why); }

template <class T>
T numberAt(const std::vector<unsigned char> &bytes, std::size_t offset) {
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// The first n bytes from offset; fewer at the end of the file.
std::vector<unsigned char> read(std::ifstream &in, std::uint64_t offset, std::size_t n) {
  std::vector<unsigned char> bytes(n);
  in.clear();
  in.seekg(static_cast<std::streamoff>(offset));
  in.read(reinterpret_cast<char *>(bytes.data()), static_cast<std::streamsize>(n));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
  return bytes;
}

bool startsWith(const std::vector<unsigned char> &bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

constexpr std::uint16_t kElfShared = 3;
#if defined(__x86_64__) || defined(_M_X64)
constexpr std::uint16_t kElfMachine = 62, kPeMachine = 0x8664;
#elif defined(__aarch64__) || defined(_M_ARM64)
constexpr std::uint16_t kElfMachine = 183, kPeMachine = 0xaa64;
#else
constexpr std::uint16_t kElfMachine = 0, kPeMachine = 0;  // 0: any
#endif

Expected<void> checkElf(std::ifstream &in, std::uint64_t size) {
  constexpr std::size_t kHeader = 64, kProgramHeader = 56;
  const auto header = read(in, 0, kHeader);
  if (header.size() < kHeader) return notAPlugin(fmt::format("the file is truncated ({} bytes)", size));
  if (header[4] != 2 || header[5] != 1) return notAPlugin("a library, but not a 64-bit little-endian one");
  if (numberAt<std::uint16_t>(header, 16) != kElfShared) return notAPlugin("an ELF file, but not a shared library");
  const auto machine = numberAt<std::uint16_t>(header, 18);
  if (kElfMachine != 0 && machine != kElfMachine)
    return notAPlugin(fmt::format("built for another processor (ELF machine {}, this is {})", machine, kElfMachine));

  // If a segment or the section table extends beyond the end, the loader would map it and the process would fault.
  std::uint64_t needed = numberAt<std::uint64_t>(header, 40) +
                         std::uint64_t{numberAt<std::uint16_t>(header, 58)} * numberAt<std::uint16_t>(header, 60);
  const auto segments = numberAt<std::uint16_t>(header, 56);
  const auto table = read(in, numberAt<std::uint64_t>(header, 32), segments * kProgramHeader);
  if (numberAt<std::uint16_t>(header, 54) != kProgramHeader || table.size() < segments * kProgramHeader)
    return notAPlugin(fmt::format("the file is truncated ({} bytes)", size));
  for (std::size_t i = 0; i < segments; ++i) {
    const auto offset = numberAt<std::uint64_t>(table, i * kProgramHeader + 8);
    const auto inFile = numberAt<std::uint64_t>(table, i * kProgramHeader + 32);
    if (inFile > size || offset > size) needed = std::max(needed, std::max(inFile, offset));
    needed = std::max(needed, offset + inFile);
  }
  if (needed > size)
    return notAPlugin(fmt::format("the file is truncated ({} bytes, its headers speak of {})", size, needed));
  return {};
}

/// The end of what the headers of a library for Windows name: sections, symbols and their names. 0: the tables are incomplete.
/// @param at  of the header
std::uint64_t peEnd(std::ifstream &in, std::uint64_t at, const std::vector<unsigned char> &header) {
  constexpr std::size_t kHeader = 24, kSection = 40, kSymbol = 18;
  const std::size_t sections = numberAt<std::uint16_t>(header, 6);
  const auto table = read(in, at + kHeader + numberAt<std::uint16_t>(header, 20), sections * kSection);
  if (table.size() < sections * kSection) return 0;
  std::uint64_t end = 0;
  for (std::size_t i = 0; i < sections; ++i)
    if (const auto bytes = numberAt<std::uint32_t>(table, i * kSection + 16); bytes != 0)
      end = std::max(end, std::uint64_t{numberAt<std::uint32_t>(table, i * kSection + 20)} + bytes);
  if (const std::uint64_t symbols = numberAt<std::uint32_t>(header, 12); symbols != 0) {
    const std::uint64_t names = symbols + std::uint64_t{numberAt<std::uint32_t>(header, 16)} * kSymbol;
    const auto length = read(in, names, 4);
    if (length.size() < 4) return 0;
    end = std::max(end, names + numberAt<std::uint32_t>(length, 0));
  }
  return end;
}

Expected<void> checkPe(std::ifstream &in, std::uint64_t size) {
  const auto dos = read(in, 0, 64);
  const std::uint64_t at = dos.size() < 64 ? 0 : numberAt<std::uint32_t>(dos, 60);
  const auto header = dos.size() < 64 ? std::vector<unsigned char>() : read(in, at, 24);
  if (header.size() < 24 || !startsWith(header, std::string_view("PE\0\0", 4)))
    return notAPlugin(fmt::format("the file is truncated ({} bytes)", size));
  const auto machine = numberAt<std::uint16_t>(header, 4);
  if (kPeMachine != 0 && machine != kPeMachine)
    return notAPlugin(
        fmt::format("built for another processor (PE machine {:#x}, this is {:#x})", machine, kPeMachine));
  constexpr std::uint16_t kDll = 0x2000;
  if ((numberAt<std::uint16_t>(header, 22) & kDll) == 0) return notAPlugin("a program, not a shared library");
  const std::uint64_t needed = peEnd(in, at, header);
  if (needed == 0) return notAPlugin(fmt::format("the file is truncated ({} bytes)", size));
  if (needed > size)
    return notAPlugin(fmt::format("the file is truncated ({} bytes, its headers speak of {})", size, needed));
  return {};
}

}  // namespace

Expected<void> checkLibraryFile(const std::filesystem::path &file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) return fail(ErrorCode::plugin, "there is no such file");
  if (!std::filesystem::is_regular_file(status)) return notAPlugin("not a file");
  if (file.extension() != pluginExtension())
    return notAPlugin(
        fmt::format("the name ends in '{}', expected is '{}'", file.extension().string(), pluginExtension()));
  std::ifstream in(file, std::ios::binary);
  if (!in) return fail(ErrorCode::plugin, "the file cannot be read");
  const std::uint64_t size = std::filesystem::file_size(file, error);

  const auto magic = read(in, 0, 4);
  const bool isElf = startsWith(magic,
                                "\x7f"
                                "ELF");
  const bool isPe = startsWith(magic, "MZ");
  const bool wantsPe = std::string_view(pluginExtension()) == ".dll";
  if (isElf && wantsPe) return notAPlugin("a library for another system (ELF)");
  if (isPe && !wantsPe) return notAPlugin("a library for another system (Windows)");
  if (isElf) return checkElf(in, size);
  if (isPe) return checkPe(in, size);
  return notAPlugin("not a shared library");
}

}  // namespace c3de::plugin_host
