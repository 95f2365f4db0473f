# The build machine's Java compiler and its jni.h, which is the same for all Linux targets.
# Sets ALIDADE_JAVA (TRUE when both were found), ALIDADE_JNI_INCLUDE, Java_JAVAC_EXECUTABLE, Java_JAVA_EXECUTABLE.
find_package(Java 11 COMPONENTS Development QUIET)
set(ALIDADE_JAVA FALSE)
if(Java_Development_FOUND)
  get_filename_component(JDK ${Java_JAVAC_EXECUTABLE} REALPATH)  # the JDK's bin/javac
  get_filename_component(JDK ${JDK} DIRECTORY)
  get_filename_component(JDK ${JDK} DIRECTORY)
  if(EXISTS ${JDK}/include/jni.h)
    set(ALIDADE_JAVA TRUE)
    set(ALIDADE_JNI_INCLUDE ${JDK}/include ${JDK}/include/linux)
  endif()
endif()
