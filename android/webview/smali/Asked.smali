# Handles the page's requests for the camera and for a video file.
.class public Lorg/alidade/page/Asked;
.super Landroid/webkit/WebChromeClient;

.field private final main:Lorg/alidade/page/Main;

.method public constructor <init>(Lorg/alidade/page/Main;)V
    .registers 2
    invoke-direct {p0}, Landroid/webkit/WebChromeClient;-><init>()V
    iput-object p1, p0, Lorg/alidade/page/Asked;->main:Lorg/alidade/page/Main;
    return-void
.end method

# Only the app's own page is shown (see Files). It may use the camera and nothing else.
.method public onPermissionRequest(Landroid/webkit/PermissionRequest;)V
    .registers 5
    const/4 v0, 0x1
    new-array v0, v0, [Ljava/lang/String;
    const/4 v1, 0x0
    const-string v2, "android.webkit.resource.VIDEO_CAPTURE"
    aput-object v2, v0, v1
    invoke-virtual {p1, v0}, Landroid/webkit/PermissionRequest;->grant([Ljava/lang/String;)V
    return-void
.end method

.method public onShowFileChooser(Landroid/webkit/WebView;Landroid/webkit/ValueCallback;Landroid/webkit/WebChromeClient$FileChooserParams;)Z
    .registers 8
    iget-object v0, p0, Lorg/alidade/page/Asked;->main:Lorg/alidade/page/Main;
    const/4 v1, 0x1
    :begin
    invoke-virtual {p3}, Landroid/webkit/WebChromeClient$FileChooserParams;->createIntent()Landroid/content/Intent;
    move-result-object v2
    invoke-virtual {v0, v2, v1}, Lorg/alidade/page/Main;->startActivityForResult(Landroid/content/Intent;I)V
    :end
    .catch Landroid/content/ActivityNotFoundException; {:begin .. :end} :nothing_chooses
    iput-object p2, v0, Lorg/alidade/page/Main;->chosen:Landroid/webkit/ValueCallback;
    return v1
    :nothing_chooses
    move-exception v2
    const/4 v1, 0x0
    return v1
.end method
