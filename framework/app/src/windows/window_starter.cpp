// SPDX-License-Identifier: Apache-2.0
// c3de-window.exe, which the Start menu and session files start: runs c3de-workstation.exe beside it with the same
// arguments and without a console window. Where that program fails, a box shows the end of its error output.
#include <windows.h>

#include <shlwapi.h>

#include <filesystem>
#include <string>
#include <utility>

namespace {

constexpr std::size_t kShownBytes = 2000;

std::filesystem::path workstationProgram() {
  std::wstring path(32768, L'\0');
  path.resize(GetModuleFileNameW(nullptr, path.data(), static_cast<DWORD>(path.size())));
  return std::filesystem::path(path).parent_path() / L"c3de-workstation.exe";
}

void showError(const std::wstring &text) { MessageBoxW(nullptr, text.c_str(), L"C3DE", MB_OK | MB_ICONERROR); }

/// The last kShownBytes that come through the pipe; returns when the other side has closed it.
std::string readEnd(HANDLE pipe) {
  std::string text;
  char buffer[4096];
  DWORD count = 0;
  while (ReadFile(pipe, buffer, sizeof buffer, &count, nullptr) && count > 0) {
    text.append(buffer, count);
    if (text.size() > kShownBytes) text.erase(0, text.size() - kShownBytes);
  }
  return text;
}

std::wstring wide(const std::string &text) {
  const int size = static_cast<int>(text.size());
  std::wstring result(static_cast<std::size_t>(MultiByteToWideChar(CP_UTF8, 0, text.data(), size, nullptr, 0)), L'\0');
  MultiByteToWideChar(CP_UTF8, 0, text.data(), size, result.data(), static_cast<int>(result.size()));
  return result;
}

/// Runs the program to its end and returns its exit code and the end of its error output.
std::pair<DWORD, std::string> run(const std::filesystem::path &program, std::wstring line) {
  SECURITY_ATTRIBUTES inherited{sizeof(SECURITY_ATTRIBUTES), nullptr, TRUE};
  HANDLE reading = nullptr, writeEnd = nullptr;
  if (!CreatePipe(&reading, &writeEnd, &inherited, 0)) return {GetLastError(), "no pipe"};
  SetHandleInformation(reading, HANDLE_FLAG_INHERIT, 0);
  const HANDLE nothing = CreateFileW(L"NUL", GENERIC_READ | GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_WRITE,
                                     &inherited, OPEN_EXISTING, 0, nullptr);
  STARTUPINFOW startup{};
  startup.cb = sizeof startup;
  startup.dwFlags = STARTF_USESTDHANDLES;
  startup.hStdInput = nothing;
  startup.hStdOutput = nothing;
  startup.hStdError = writeEnd;
  PROCESS_INFORMATION process{};
  const BOOL started = CreateProcessW(program.c_str(), line.data(), nullptr, nullptr, TRUE, CREATE_NO_WINDOW, nullptr,
                                      nullptr, &startup, &process);
  DWORD code = started ? 1 : GetLastError();
  CloseHandle(writeEnd);
  CloseHandle(nothing);
  std::string text = started ? readEnd(reading) : "the program cannot be started";
  CloseHandle(reading);
  if (started) {
    WaitForSingleObject(process.hProcess, INFINITE);
    GetExitCodeProcess(process.hProcess, &code);
    CloseHandle(process.hThread);
    CloseHandle(process.hProcess);
  }
  return {code, std::move(text)};
}

}  // namespace

int WINAPI WinMain(HINSTANCE, HINSTANCE, LPSTR, int) {
  const std::filesystem::path program = workstationProgram();
  const auto [code, text] =
      run(program, L"\"" + program.wstring() + L"\" " + std::wstring(PathGetArgsW(GetCommandLineW())));
  if (code != 0)
    showError(L"C3DE ended with exit code " + std::to_wstring(code) + L" (" + program.wstring() + L")\n\n" +
              wide(text));
  return static_cast<int>(code);
}
