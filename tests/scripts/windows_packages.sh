#!/usr/bin/env bash
# The packages for Windows, under wine: windows_packages.sh ROOT BUILD FOLDER. Writes the installer and the archive of BUILD into FOLDER; they
# need no libraries of others; the archive runs the first scene from its folder; the installer installs without a question,
# the scene runs, files of sessions belong to the window, and removal leaves only the file of another program.
set -euo pipefail
root=$1 build=$2 folder=$3
wine=$root/tools/windows/wine.sh
prefix=${C3DE_WINE_PREFIX:-$root/build/windows/wine}
for tool in makensis x86_64-w64-mingw32-objdump; do
  command -v "$tool" >/dev/null || { echo "[C3DE-SKIPPED] $tool is missing (tools/debian-packages-windows.txt)"; exit 0; }
done
[ -x /usr/lib/wine/wine64 ] || { echo "[C3DE-SKIPPED] wine64 is missing (tools/debian-packages-windows.txt)"; exit 0; }
[ -e "$build/bin/c3de.exe" ] || { echo "[C3DE-SKIPPED] c3de.exe is not built in $build"; exit 0; }

failed=0
wrong() {
  echo "wrong: $*" >&2
  failed=1
}
rm -rf "$folder"
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
export C3DE_HOME="Z:${folder//\//\\}\\home"

# Packed quickly: the compression of a release takes a minute of processor time.
(cd "$build" && cpack --config CPackConfig.cmake -G "ZIP;NSIS" -D CPACK_NSIS_COMPRESSOR=zlib -B "$folder/packages" >"$folder/cpack.log" 2>&1) || {
  tail -n 20 "$folder/cpack.log" >&2
  exit 1
}
archive=$(echo "$folder"/packages/c3de-*-windows-*.zip)
installer=$(echo "$folder"/packages/c3de-*-windows-*.exe)

# --- archive ------------------------------------------------------------------------------------------------------------------
mkdir "$folder/of archive"
(cd "$folder/of archive" && cmake -E tar xf "$archive")
unpacked=$(echo "$folder/of archive"/c3de-*)
for file in bin/c3de.exe bin/c3de-workstation.exe bin/c3de-window.exe bin/c3de-validate.exe lib/c3de/plugins/pointbased.dll \
  lib/c3de/study/baselines.dll share/c3de/materials.toml share/c3de/scenes/first_light.toml share/doc/c3de/LICENSE \
  share/doc/c3de/NOTICE share/doc/c3de/licences/gcc.txt share/doc/c3de/docs/user/index.md; do
  [ -s "$unpacked/$file" ] || wrong "the archive has no $file"
done
system='^(ADVAPI32|bcrypt|COMCTL32|COMDLG32|CRYPT32|dbghelp|GDI32|IMM32|KERNEL32|msvcrt|ole32|OLEAUT32|OPENGL32|PSAPI|RPCRT4|SHELL32|SHLWAPI|USER32|VERSION|WINMM|WS2_32)\.dll$'
while IFS= read -r binary; do
  others=$(x86_64-w64-mingw32-objdump -p "$binary" | sed -n 's/^[[:space:]]*DLL Name: //p' | grep -viE "$system" || true)
  [ -z "$others" ] || wrong "$(basename "$binary") needs $others, which Windows does not have"
done < <(find "$unpacked" -name '*.exe' -o -name '*.dll')
[[ $(x86_64-w64-mingw32-objdump -p "$unpacked/bin/c3de-window.exe") == *"(Windows GUI)"* ]] || wrong "c3de-window.exe opens a console window"
version=$(sed -n 's/^project(C3DE VERSION \([0-9.]*\).*/\1/p' "$root/CMakeLists.txt")
for binary in bin/c3de.exe bin/c3de-workstation.exe lib/c3de/plugins/pointbased.dll; do
  # A resource is UTF-16.
  [ "$(tr -d '\0' <"$unpacked/$binary" | grep -ca "ProductVersion.*$version")" -gt 0 ] || wrong "$binary has no version $version"
done

# run_scene FOLDER REPORT: the first scene, for a few steps and without a window.
run_scene() {
  (cd "$1" && "$wine" bin/c3de.exe run share/c3de/scenes/first_light.toml --until 0.2 --report "Z:${2//\//\\}" -q) >"$2.log" 2>&1 || {
    cat "$2.log" >&2
    wrong "c3de.exe run ended with an error in $1"
    return 0
  }
  grep -q '"state_hash"' "$2" || wrong "the report of $1 has no state_hash"
}
run_scene "$unpacked" "$folder/archive.json"

# --- installer ----------------------------------------------------------------------------------------------------------------
installed="$prefix/drive_c/C3DE of a test"
menu="$prefix/drive_c/ProgramData/Microsoft/Windows/Start Menu/Programs"
keys=('HKLM\Software\Classes\.c3de' 'HKLM\Software\Classes\.c3dr' 'HKLM\Software\Classes\C3DE.Session'
  'HKLM\Software\Microsoft\Windows\CurrentVersion\Uninstall\C3DE' 'HKLM\Software\C3DE')
present() { "$wine" reg query "$1" >/dev/null 2>&1; }
# value KEY [NAME]
value() { "$wine" reg query "$1" ${2:+/v "$2"} 2>/dev/null | tr -d '\r' || true; }
[ ! -e "$installed" ] || { echo "wrong: $installed is there already" >&2; exit 1; }
for key in "${keys[@]}"; do
  ! present "$key" || wrong "the registry had $key before the installation"
done
# Without a display, as on a machine that is set up by a script. NSIS wants the folder without quotation marks.
env -u DISPLAY "$wine" "$installer" /S '/D=C:\C3DE' of a test || wrong "the installer ended with $?"
(cd "$unpacked" && find . -type f | sort) >"$folder/of_archive.txt"
(cd "$installed" && find . -type f ! -name Uninstall.exe | sort) >"$folder/of_installer.txt"
diff "$folder/of_archive.txt" "$folder/of_installer.txt" >&2 || wrong "the installer and the archive have different files"
[ -n "$(find "$menu" -name 'C3DE*.lnk')" ] || wrong "the Start menu has no entry: $(find "$menu" 2>&1)"
command=$("$wine" reg query 'HKLM\Software\Classes\C3DE.Session\shell\open\command' /ve 2>/dev/null | tr -d '\r')
[[ $command == *'C3DE of a test\bin\c3de-window.exe" "%1"'* ]] || wrong "sessions do not open in the window: $command"
for kind in .c3de .c3dr; do
  [[ $(value "HKLM\\Software\\Classes\\$kind") == *C3DE.Session* ]] || wrong "files $kind belong to no program"
done
[[ $(value "${keys[3]}" DisplayVersion) == *"$version"* ]] || wrong "the list of programs does not have version $version"
run_scene "$installed" "$folder/installed.json"
hashes=$(sed -n 's/.*"state_hash": *"\([^"]*\)".*/\1/p' "$folder/archive.json" "$folder/installed.json" | sort -u | wc -l)
[ "$hashes" -eq 1 ] || wrong "archive and installation have $hashes states at the end of the scene"

# --- removal ------------------------------------------------------------------------------------------------------------------
echo other >"$installed/of_another_program.txt"
env -u DISPLAY "$wine" "$installed/Uninstall.exe" /S || wrong "Uninstall.exe ended with $?"
# It goes on in a copy of itself.
for _ in $(seq 120); do
  [ -e "$installed/Uninstall.exe" ] || present "${keys[3]}" || break
  sleep 0.5
done
left=$(find "$installed" -mindepth 1 2>/dev/null | sed "s|^$installed/||")
[ "$left" = of_another_program.txt ] || wrong "after removal only the file of another program was to be left: $left"
left=$(find "$menu" -iname '*c3de*')
[ -z "$left" ] || wrong "the Start menu still has $left"
for key in "${keys[@]}"; do
  ! present "$key" || wrong "the registry still has $key"
done
rm -rf "$installed"
[ "$failed" -ne 0 ] || echo "archive $(($(stat -c %s "$archive") / 1000000)) MB, $(wc -l <"$folder/of_archive.txt") files"
exit "$failed"
