// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>

#include "c3de/core/input_file.h"
#include "c3de/core/path_text.h"
#include "c3de/session/session_file.h"

namespace c3de::session {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kChunk = std::size_t{1} << 20;
constexpr std::size_t kMostFiles = 100'000;  // of a folder

std::string slashed(const fs::path &path) {
  const std::u8string text = path.generic_u8string();
  return {text.begin(), text.end()};
}

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new()) {
    isGood_ = context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1;
  }
  void add(std::string_view bytes) {
    isGood_ = isGood_ && EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) == 1;
  }
  Expected<std::string> digits() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned size = 0;
    if (!isGood_ || EVP_DigestFinal_ex(context_.get(), digest.data(), &size) != 1)
      return fail(ErrorCode::internal, "OpenSSL computes no SHA-256");
    std::string out;
    for (unsigned i = 0; i < size; ++i) out += fmt::format("{:02x}", digest[i]);
    return out;
  }

 private:
  struct Free {
    void operator()(EVP_MD_CTX *context) const { EVP_MD_CTX_free(context); }
  };
  std::unique_ptr<EVP_MD_CTX, Free> context_;
  bool isGood_ = false;
};

/// Reports a part of work that is measured in bytes.
class ByteProgress {
 public:
  ByteProgress(const ProgressFn &report, std::uint64_t total) : report_(report), total_(total) {}
  Expected<void> add(std::uint64_t bytes, const std::string &name) {
    done_ += bytes;
    const double fraction =
        total_ == 0 ? -1.0 : std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_));
    if (report_ && !report_(fraction, "Checking " + name)) return fail(ErrorCode::cancelled, "cancelled");
    return {};
  }

 private:
  const ProgressFn &report_;
  std::uint64_t total_ = 0, done_ = 0;
};

Expected<std::string> hashOfFile(const fs::path &file, ByteProgress &progress) {
  auto in = openInputFile(file);
  if (!in) return tl::unexpected(in.error());
  const std::string name = pathText(file.filename());
  Sha256 hash;
  std::string chunk(kChunk, '\0');
  do {
    in->read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
    const auto count = static_cast<std::size_t>(in->gcount());
    hash.add(std::string_view(chunk).substr(0, count));
    if (const auto goOn = progress.add(count, name); !goOn) return tl::unexpected(goOn.error());
  } while (*in);
  if (in->bad()) return fail(ErrorCode::input, pathText(file) + ": cannot be read");
  return hash.digits();
}

struct Content {
  fs::path path;
  std::vector<fs::path> files;  ///< of a folder: relative to it, in order; of a file: empty
  bool isFolder = false;
  std::uint64_t bytes = 0;
};

/// Files below a folder, links to files included.
/// @param enoughBytes  of a folder that has more, the rest is not listed
Expected<Content> contentOf(const fs::path &path,
                            std::uint64_t enoughBytes = std::numeric_limits<std::uint64_t>::max()) {
  Content content{path, {}, false, 0};
  std::error_code code;
  const auto unreadable = [&] {
    return fail(ErrorCode::input, fmt::format("{}: cannot be read: {}", pathText(path), code.message()));
  };
  content.isFolder = fs::is_directory(path, code);
  if (!content.isFolder) {
    if (const auto good = checkInputFile(path); !good) return tl::unexpected(good.error());
    content.bytes = fs::file_size(path, code);
    if (code) return unreadable();
    return content;
  }
  for (fs::recursive_directory_iterator at(path, code), end; !code && at != end; at.increment(code)) {
    if (!at->is_regular_file(code)) continue;
    content.files.push_back(at->path().lexically_relative(path));
    content.bytes += at->file_size(code);
    if (code || content.bytes > enoughBytes) break;
    if (content.files.size() > kMostFiles)
      return fail(ErrorCode::input, fmt::format("{}: has more than {} files", pathText(path), kMostFiles));
  }
  if (code) return unreadable();
  std::sort(content.files.begin(), content.files.end(),
            [](const fs::path &a, const fs::path &b) { return slashed(a) < slashed(b); });
  return content;
}

Expected<std::string> hashOf(const Content &content, ByteProgress &progress) {
  if (!content.isFolder) return hashOfFile(content.path, progress);
  Sha256 hash;
  for (const fs::path &file : content.files) {
    const auto one = hashOfFile(content.path / file, progress);
    if (!one) return one;
    hash.add(fmt::format("{}  {}\n", *one, slashed(file)));
  }
  return hash.digits();
}

/// Where a file may be, in the order of preference.
std::vector<fs::path> candidates(const ReferencedFile &file, const fs::path &sessionFolder) {
  const fs::path path = pathFromText(file.path);
  std::vector<fs::path> out{sessionFolder / path};
  const fs::path name = path.has_filename() ? path.filename() : path.parent_path().filename();
  if (sessionFolder / name != out.front() && !name.empty()) out.push_back(sessionFolder / name);
  return out;
}

Expected<FoundFile> find(const ReferencedFile &file, const fs::path &sessionFolder, ByteProgress &progress) {
  FoundFile found{file, {}, FoundFile::State::missing};
  for (const fs::path &candidate : candidates(file, sessionFolder)) {
    const auto content = contentOf(candidate, file.bytes);
    if (!content) continue;
    bool isSame = content->bytes == file.bytes;
    if (isSame) {
      const auto hash = hashOf(*content, progress);
      if (!hash && hash.error().code == ErrorCode::cancelled) return tl::unexpected(hash.error());
      if (!hash) continue;
      isSame = *hash == file.sha256;
    }
    if (isSame) return FoundFile{file, candidate, FoundFile::State::same};
    if (found.at.empty()) found = {file, candidate, FoundFile::State::changed};
  }
  return found;
}

}  // namespace

Expected<std::string> sha256Of(const fs::path &path, const ProgressFn &progress) {
  const auto content = contentOf(path);
  if (!content) return tl::unexpected(content.error());
  ByteProgress bytes(progress, content->bytes);
  return hashOf(*content, bytes);
}

std::string referencePath(const fs::path &path, const fs::path &sessionFolder) {
  std::error_code code;
  fs::path absolute = fs::weakly_canonical(fs::absolute(path, code), code);
  if (!absolute.has_filename()) absolute = absolute.parent_path();
  const fs::path folder = fs::weakly_canonical(fs::absolute(sessionFolder.empty() ? "." : sessionFolder, code), code);
  const fs::path relative = absolute.lexically_relative(folder);
  return slashed(relative.empty() ? absolute : relative);
}

Expected<ReferencedFile> referenceTo(const fs::path &path, const fs::path &sessionFolder, const ProgressFn &progress) {
  const auto content = contentOf(path);
  if (!content) return tl::unexpected(content.error());
  ByteProgress bytes(progress, content->bytes);
  auto hash = hashOf(*content, bytes);
  if (!hash) return tl::unexpected(hash.error());
  return ReferencedFile{referencePath(path, sessionFolder), std::move(*hash), content->bytes, false};
}

Expected<std::vector<FoundFile>> findFiles(const SessionFile &session, const fs::path &sessionFolder,
                                           const ProgressFn &progress) {
  std::uint64_t total = 0;
  for (const ReferencedFile &file : session.files)
    if (!file.isEmbedded) total += file.bytes;
  ByteProgress bytes(progress, total);
  std::vector<FoundFile> out;
  for (const ReferencedFile &file : session.files) {
    if (file.isEmbedded) {
      out.push_back({file, {}, FoundFile::State::same});
      continue;
    }
    auto found = find(file, sessionFolder, bytes);
    if (!found) return tl::unexpected(found.error());
    out.push_back(std::move(*found));
  }
  return out;
}

}  // namespace c3de::session
