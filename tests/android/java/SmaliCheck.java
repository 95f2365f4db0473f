package org.alidade.phone;

import java.io.IOException;
import java.lang.invoke.MethodType;
import java.nio.file.DirectoryStream;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.regex.Matcher;
import java.util.regex.Pattern;

/**
 * SmaliCheck FOLDER [CLASS…]: each method that the smali files of a folder call is one that the class
 * path has (Android's public API as stubs, Java's own, theirs), and the classes named, translated
 * back from the dex, pass the JVM's verifier.
 */
public final class SmaliCheck {
  private static final Pattern CALL =
      Pattern.compile("invoke-(virtual|direct|static|interface|super)(?:/range)? \\{.*\\}, L([^;]+);->([^(]+)(\\(.*)");

  private SmaliCheck() {}

  public static void main(String[] arguments) throws Exception {
    Check check = new Check();
    try (DirectoryStream<Path> files = Files.newDirectoryStream(Path.of(arguments[0]), "*.smali")) {
      for (Path file : files) check.test(file.getFileName() + " calls what there is", () -> calls(file));
    }
    for (int i = 1; i < arguments.length; ++i) {
      String name = arguments[i];
      check.test(name + " passes the verifier", () -> Class.forName(name).getMethods());
    }
    System.exit(check.status());
  }

  private static void calls(Path file) throws IOException {
    int calls = 0;
    for (String line : Files.readAllLines(file)) {
      Matcher call = CALL.matcher(line);
      if (!line.contains("invoke-")) continue;
      Check.that(call.find(), "not understood: " + line);
      ++calls;
      String type = call.group(2).replace('/', '.');
      try {
        ClassLoader loader = SmaliCheck.class.getClassLoader();
        Class<?> owner = Class.forName(type, false, loader);
        MethodType signature = MethodType.fromMethodDescriptorString(call.group(4).trim(), loader);
        find(owner, call.group(3), signature, call.group(1).equals("static"), call.group(1).equals("interface"));
      } catch (ReflectiveOperationException | TypeNotPresentException e) {
        throw new AssertionError(line.trim() + ": " + e, e);
      }
    }
    Check.that(calls > 0, "no calls");
  }

  // A method of the class or of one above it, or a constructor; public or protected.
  private static void find(Class<?> owner, String name, MethodType signature, boolean isStatic, boolean isInterface)
      throws ReflectiveOperationException {
    Check.that(owner.isInterface() == isInterface, owner + (isInterface ? " is no interface" : " is an interface"));
    if (name.equals("<init>")) {
      owner.getDeclaredConstructor(signature.parameterArray());
      return;
    }
    for (Class<?> each = owner; each != null; each = each.getSuperclass()) {
      try {
        java.lang.reflect.Method method = each.getDeclaredMethod(name, signature.parameterArray());
        boolean fits =
            method.getReturnType() == signature.returnType()
                && java.lang.reflect.Modifier.isStatic(method.getModifiers()) == isStatic;
        Check.that(fits, owner + "." + name + " is not as it is called");
        return;
      } catch (NoSuchMethodException e) {
        // one further up
      }
    }
    throw new NoSuchMethodException(owner + "." + name + signature);
  }
}
