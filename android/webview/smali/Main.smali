# An app that shows the phone page and gives it access to the camera. Written in smali, because
# Debian has no compiler from Java to Android bytecode; tests/android checks every call against the
# public API.
.class public Lorg/alidade/page/Main;
.super Landroid/app/Activity;

.field private view:Landroid/webkit/WebView;
.field chosen:Landroid/webkit/ValueCallback;  # callback waiting for the user's file choice, or null

.method public constructor <init>()V
    .registers 1
    invoke-direct {p0}, Landroid/app/Activity;-><init>()V
    return-void
.end method

.method protected onCreate(Landroid/os/Bundle;)V
    .registers 6
    invoke-super {p0, p1}, Landroid/app/Activity;->onCreate(Landroid/os/Bundle;)V
    invoke-virtual {p0}, Lorg/alidade/page/Main;->getWindow()Landroid/view/Window;
    move-result-object v0
    const/16 v1, 0x80  # FLAG_KEEP_SCREEN_ON
    invoke-virtual {v0, v1}, Landroid/view/Window;->addFlags(I)V

    new-instance v0, Landroid/webkit/WebView;
    invoke-direct {v0, p0}, Landroid/webkit/WebView;-><init>(Landroid/content/Context;)V
    iput-object v0, p0, Lorg/alidade/page/Main;->view:Landroid/webkit/WebView;
    invoke-virtual {v0}, Landroid/webkit/WebView;->getSettings()Landroid/webkit/WebSettings;
    move-result-object v1
    const/4 v2, 0x1
    const/4 v3, 0x0
    invoke-virtual {v1, v2}, Landroid/webkit/WebSettings;->setJavaScriptEnabled(Z)V
    invoke-virtual {v1, v2}, Landroid/webkit/WebSettings;->setDomStorageEnabled(Z)V
    invoke-virtual {v1, v3}, Landroid/webkit/WebSettings;->setMediaPlaybackRequiresUserGesture(Z)V
    invoke-virtual {v1, v3}, Landroid/webkit/WebSettings;->setAllowFileAccess(Z)V
    new-instance v1, Lorg/alidade/page/Files;
    invoke-virtual {p0}, Lorg/alidade/page/Main;->getAssets()Landroid/content/res/AssetManager;
    move-result-object v3
    invoke-direct {v1, v3}, Lorg/alidade/page/Files;-><init>(Landroid/content/res/AssetManager;)V
    invoke-virtual {v0, v1}, Landroid/webkit/WebView;->setWebViewClient(Landroid/webkit/WebViewClient;)V
    new-instance v1, Lorg/alidade/page/Asked;
    invoke-direct {v1, p0}, Lorg/alidade/page/Asked;-><init>(Lorg/alidade/page/Main;)V
    invoke-virtual {v0, v1}, Landroid/webkit/WebView;->setWebChromeClient(Landroid/webkit/WebChromeClient;)V
    invoke-virtual {p0, v0}, Lorg/alidade/page/Main;->setContentView(Landroid/view/View;)V

    # Ask for the camera permission early, so that it is granted before the page requests the
    # camera. The page reports a refusal.
    const-string v1, "android.permission.CAMERA"
    invoke-virtual {p0, v1}, Lorg/alidade/page/Main;->checkSelfPermission(Ljava/lang/String;)I
    move-result v3
    if-eqz v3, :open
    new-array v3, v2, [Ljava/lang/String;
    const/4 v2, 0x0
    aput-object v1, v3, v2
    invoke-virtual {p0, v3, v2}, Lorg/alidade/page/Main;->requestPermissions([Ljava/lang/String;I)V
    :open
    # Secure pages only may use the camera. This host does not exist (RFC 2606); all requests are
    # answered from the app's assets.
    const-string v1, "https://alidade.invalid/"
    invoke-virtual {v0, v1}, Landroid/webkit/WebView;->loadUrl(Ljava/lang/String;)V
    return-void
.end method

# The hidden page releases the camera.
.method protected onPause()V
    .registers 2
    iget-object v0, p0, Lorg/alidade/page/Main;->view:Landroid/webkit/WebView;
    invoke-virtual {v0}, Landroid/webkit/WebView;->onPause()V
    invoke-super {p0}, Landroid/app/Activity;->onPause()V
    return-void
.end method

.method protected onResume()V
    .registers 2
    invoke-super {p0}, Landroid/app/Activity;->onResume()V
    iget-object v0, p0, Lorg/alidade/page/Main;->view:Landroid/webkit/WebView;
    invoke-virtual {v0}, Landroid/webkit/WebView;->onResume()V
    return-void
.end method

.method protected onDestroy()V
    .registers 2
    iget-object v0, p0, Lorg/alidade/page/Main;->view:Landroid/webkit/WebView;
    invoke-virtual {v0}, Landroid/webkit/WebView;->destroy()V
    invoke-super {p0}, Landroid/app/Activity;->onDestroy()V
    return-void
.end method

# Result of the file chooser.
.method protected onActivityResult(IILandroid/content/Intent;)V
    .registers 6
    invoke-super {p0, p1, p2, p3}, Landroid/app/Activity;->onActivityResult(IILandroid/content/Intent;)V
    iget-object v0, p0, Lorg/alidade/page/Main;->chosen:Landroid/webkit/ValueCallback;
    if-eqz v0, :nobody
    invoke-static {p2, p3}, Landroid/webkit/WebChromeClient$FileChooserParams;->parseResult(ILandroid/content/Intent;)[Landroid/net/Uri;
    move-result-object v1
    invoke-interface {v0, v1}, Landroid/webkit/ValueCallback;->onReceiveValue(Ljava/lang/Object;)V
    const/4 v0, 0x0
    iput-object v0, p0, Lorg/alidade/page/Main;->chosen:Landroid/webkit/ValueCallback;
    :nobody
    return-void
.end method
