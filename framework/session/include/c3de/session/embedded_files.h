// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/session/session_file.h"

namespace c3de::session {

/// Where embedded files of sessions are extracted, below userCacheDirectory(). Each folder in it has the files of one
/// folder of an archive, and their common hash as its name, so that files that are opened twice are there once.
[[nodiscard]] std::filesystem::path extractionFolder();

/// Whether a file, or a folder, has been extracted from a session.
[[nodiscard]] bool isExtracted(const std::filesystem::path &file);

/// Extracts the embedded files of a session, unless they are there already, and sets FoundFile::at and FoundFile::use.
/// Their SHA-256 is checked in both cases. Extracted files stay while a program uses them, and for a week after that.
/// Any thread, several programs at a time. Errors: input, naming a member that is damaged or has another hash; output,
/// if the files cannot be written or the disk has not enough space; cancelled, if `progress` returns false.
/// @param session  a session or a recording
[[nodiscard]] Expected<void> extractEmbedded(const std::filesystem::path &session, std::vector<FoundFile> &files,
                                             const ProgressFn &progress = {});

/// The session or recording that a file was extracted from; empty: unknown.
[[nodiscard]] std::filesystem::path archiveOf(const std::filesystem::path &extracted);

/// Extracts the embedded files of `archive` again, and finds those of `files` among them that are missing or have
/// changed, by SHA-256. Errors: as extractEmbedded(), and those of readSession().
[[nodiscard]] Expected<void> extractAgain(const std::filesystem::path &archive, std::vector<FoundFile *> files,
                                          const ProgressFn &progress = {});

/// Removes extracted files that no program uses and that were last used a week before `now`. extractEmbedded() calls
/// it.
void removeUnusedExtractions(std::filesystem::file_time_type now = std::filesystem::file_time_type::clock::now());

/// Other files that belong to an image, a label map or a mesh: a header without them is of no use. Any thread. Errors:
/// those of imaging::companionFiles(); input, if a glTF mesh names files that cannot be embedded.
[[nodiscard]] Expected<std::vector<std::filesystem::path>> filesBelongingTo(const std::filesystem::path &file,
                                                                            const ProgressFn &progress = {});

}  // namespace c3de::session
