# Cross-compilation for 64-bit Windows by mingw-w64 (Debian package g++-mingw-w64-x86-64-posix).
# C3DE_WINDOWS_PREFIX: the folder that tools/windows/dependencies.sh has filled.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
set(CMAKE_CROSSCOMPILING_EMULATOR "${CMAKE_CURRENT_LIST_DIR}/wine.sh")

if(NOT C3DE_WINDOWS_PREFIX)
  set(C3DE_WINDOWS_PREFIX "${CMAKE_CURRENT_LIST_DIR}/../../build/windows/prefix")
endif()
get_filename_component(C3DE_WINDOWS_PREFIX "${C3DE_WINDOWS_PREFIX}" ABSOLUTE)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES C3DE_WINDOWS_PREFIX)
set(CMAKE_FIND_ROOT_PATH "${C3DE_WINDOWS_PREFIX}" /usr/x86_64-w64-mingw32)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_LIBDIR} "${C3DE_WINDOWS_PREFIX}/lib/pkgconfig")

# Programs and plugins contain the libraries, also those of the compiler: nothing has to be installed beside them.
set(BUILD_SHARED_LIBS OFF)
set(OPENSSL_USE_STATIC_LIBS ON)
set(CMAKE_FIND_LIBRARY_SUFFIXES .a)
# FindZLIB prefers the import library of zlib1.dll.
set(ZLIB_LIBRARY /usr/x86_64-w64-mingw32/lib/libz.a CACHE FILEPATH "zlib")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-static -L${C3DE_WINDOWS_PREFIX}/lib")
set(CMAKE_SHARED_LINKER_FLAGS_INIT "-static -L${C3DE_WINDOWS_PREFIX}/lib")
set(CMAKE_MODULE_LINKER_FLAGS_INIT "-static -L${C3DE_WINDOWS_PREFIX}/lib")
