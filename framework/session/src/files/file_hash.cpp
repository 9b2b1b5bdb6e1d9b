// SPDX-License-Identifier: Apache-2.0
#include "files/file_hash.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "c3de/core/file_path.h"
#include "c3de/core/input_file.h"
#include "c3de/core/path_text.h"

namespace c3de::session {
namespace {

namespace fs = std::filesystem;

}  // namespace

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  isGood_ = context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1;
}

void Sha256::add(std::string_view bytes) {
  isGood_ = isGood_ && EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) == 1;
}

Expected<std::string> Sha256::digits() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  if (!isGood_ || EVP_DigestFinal_ex(context_.get(), digest.data(), &size) != 1)
    return fail(ErrorCode::internal, "OpenSSL computes no SHA-256");
  std::string out;
  for (unsigned i = 0; i < size; ++i) out += fmt::format("{:02x}", digest[i]);
  return out;
}

std::string lineOfFolder(const std::string &sha256, const std::string &name) {
  return fmt::format("{}  {}\n", sha256, name);
}

Expected<void> ByteProgress::add(std::uint64_t bytes, const std::string &name) {
  done_ += bytes;
  const double fraction = total_ == 0 ? -1.0 : std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_));
  if (report_ && !report_(fraction, verb_ + " " + name)) return fail(ErrorCode::cancelled, "cancelled");
  return {};
}

Expected<Content> contentOf(const fs::path &path, std::uint64_t enoughBytes) {
  constexpr std::size_t kMostFiles = 100'000;  // of a folder
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
            [](const fs::path &a, const fs::path &b) { return genericPathText(a) < genericPathText(b); });
  return content;
}

Expected<std::string> hashOfFile(const fs::path &file, ByteProgress &progress) {
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  auto in = openInputFile(file);
  if (!in) return tl::unexpected(in.error());
  const std::string name = pathText(file.filename());
  Sha256 hash;
  std::string piece(kPiece, '\0');
  do {
    in->read(piece.data(), static_cast<std::streamsize>(piece.size()));
    const auto count = static_cast<std::size_t>(in->gcount());
    hash.add(std::string_view(piece).substr(0, count));
    if (const auto goOn = progress.add(count, name); !goOn) return tl::unexpected(goOn.error());
  } while (*in);
  if (in->bad()) return fail(ErrorCode::input, pathText(file) + ": cannot be read");
  return hash.digits();
}

Expected<std::string> hashOf(const Content &content, ByteProgress &progress) {
  if (!content.isFolder) return hashOfFile(content.path, progress);
  Sha256 hash;
  for (const fs::path &file : content.files) {
    const auto one = hashOfFile(content.path / file, progress);
    if (!one) return one;
    hash.add(lineOfFolder(*one, genericPathText(file)));
  }
  return hash.digits();
}

}  // namespace c3de::session
