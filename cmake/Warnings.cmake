# Warnings are errors in own code; third-party headers come in as SYSTEM.
add_library(c3de_warnings INTERFACE)
if(MSVC)
  target_compile_options(c3de_warnings INTERFACE /W4 /WX /permissive- /utf-8)
  target_compile_definitions(c3de_warnings INTERFACE _CRT_SECURE_NO_WARNINGS NOMINMAX WIN32_LEAN_AND_MEAN)
else()
  target_compile_options(c3de_warnings INTERFACE
    -Wall -Wextra -Wpedantic -Werror -Wshadow -Wcast-align -Wunused -Wformat=2
    $<$<COMPILE_LANGUAGE:CXX>:-Woverloaded-virtual> $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor>
    # GCC 12 sees overlaps in std::string's operator+ that are not there (GCC bug 105651).
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
    # In a unity build sources look like headers, whose types must not use unnamed namespaces.
    $<$<AND:$<COMPILE_LANG_AND_ID:CXX,GNU>,$<BOOL:${CMAKE_UNITY_BUILD}>>:-Wno-subobject-linkage>)
  # The same bits on every machine: no contraction of a*b+c unless a kernel asks for it.
  target_compile_options(c3de_warnings INTERFACE -ffp-contract=off)
endif()
# Eigen's alignment must be the one libfcl was built with, in every translation unit.
target_compile_definitions(c3de_warnings INTERFACE EIGEN_MAX_STATIC_ALIGN_BYTES=16)
