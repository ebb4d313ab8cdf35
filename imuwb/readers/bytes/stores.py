"""Opens the store of an address with obstore: a web server, S3, Google Cloud Storage or Azure Blob Storage.

Credentials and endpoints come from the environment under the names that the tools of each store use. Without credentials the
requests are not signed, as public objects need. https://developmentseed.org/obstore lists the names.
"""

import os
from base64 import b64encode
from datetime import timedelta
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from obstore.store import AzureStore, GCSStore, HTTPStore, ObjectStore, S3Store

from imuwb.errors import UsageError
from imuwb.readers.bytes.address import WEB, Address

SILENCE = timedelta(seconds=30)  #: a server that sends nothing for so long has failed
CONNECTING = timedelta(seconds=10)
#: no limit for a whole transfer: an object may be large and a line slow
TIMES = {"read_timeout": SILENCE, "connect_timeout": CONNECTING, "timeout": timedelta(days=30)}
_NO_RETRY: Any = {"max_retries": 0}  # ``transfer`` retries, because it knows how many bytes have come
#: scheme -> the variables that show that the environment has credentials
CREDENTIALS = {
    "s3": ("AWS_ACCESS_KEY_ID", "AWS_WEB_IDENTITY_TOKEN_FILE", "AWS_CONTAINERCREDENTIALS_RELATIVE_URI",
           "AWS_CONTAINERCREDENTIALS_FULL_URI", "AWS_SKIP_SIGNATURE"),
    "gs": ("GOOGLE_SERVICE_ACCOUNT", "GOOGLE_SERVICE_ACCOUNT_PATH", "GOOGLE_SERVICE_ACCOUNT_KEY",
           "GOOGLE_APPLICATIONCREDENTIALS", "GOOGLE_BEARER_TOKEN", "GOOGLE_SKIP_SIGNATURE"),
    "az": ("AZURE_STORAGE_ACCOUNT_KEY", "AZURE_STORAGE_ACCESS_KEY", "AZURE_STORAGE_SAS_KEY", "AZURE_STORAGE_SAS_TOKEN",
           "AZURE_STORAGE_MASTER_KEY", "AZURE_STORAGE_TOKEN", "AZURE_STORAGE_CLIENT_ID", "AZURE_CLIENT_ID",
           "AZURE_USE_AZURE_CLI", "AZURE_MSI_ENDPOINT", "AZURE_IDENTITY_ENDPOINT", "AZURE_STORAGE_USE_EMULATOR",
           "AZURE_SKIP_SIGNATURE"),
}  # fmt: skip
_GCLOUD = Path("~/.config/gcloud/application_default_credentials.json")
#: scheme -> what to do when access is denied
REMEDIES = {
    "http": "check the address, and whether its signature has expired",
    "https": "check the address, and whether its signature has expired",
    "s3": "check the address, and set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY, or AWS_PROFILE (this needs boto3), and AWS_REGION or AWS_ENDPOINT_URL",
    "gs": "check the address, and set GOOGLE_APPLICATIONCREDENTIALS",
    "az": "check the address, and set AZURE_STORAGE_ACCOUNT_NAME, and AZURE_STORAGE_ACCOUNT_KEY or AZURE_STORAGE_SAS_TOKEN",
}


def store_of(address: Address) -> tuple[ObjectStore, str]:
    """Return the store of an address, and the object's path in it. Nothing is sent yet.

    Raises:
        UsageError: the environment does not state what the store needs.
    """
    if address.scheme in WEB:
        return _web(address), ""
    opened = {"s3": _s3, "gs": _gs, "az": _az}[address.scheme]
    try:
        return opened(address.host), address.key
    except UsageError:
        raise
    except Exception:  # noqa: BLE001 - of many types; their texts may show the environment
        text = f"{address}: the environment does not state what {address.scheme}:// needs; {REMEDIES[address.scheme]}"
        raise UsageError(text) from None


def _client(url: str, **more: Any) -> Any:  # noqa: ANN401 - obstore's own dictionary
    return {"allow_http": url.lower().startswith("http://"), **TIMES, **more}


def _web(address: Address) -> HTTPStore:
    """Return a store of one object: its URL is used as it is given, with its query."""
    user, mark, _ = address.authority.rpartition("@")
    url = address.url.replace(f"{user}{mark}", "", 1)
    token = b64encode(":".join(map(unquote, user.split(":", 1))).encode()).decode()
    headers = {"default_headers": {"Authorization": f"Basic {token}"}} if user else {}
    try:
        return HTTPStore(url, client_options=_client(url, **headers), retry_config=_NO_RETRY)
    except Exception:  # noqa: BLE001 - their texts show the whole URL
        raise UsageError(f"{address}: this is no valid URL; check its host and its port") from None


def _s3(bucket: str) -> S3Store:
    endpoint = _endpoint("AWS_ENDPOINT_URL_S3", "AWS_ENDPOINT_URL", "AWS_ENDPOINT")
    config: Any = {"endpoint": endpoint} if endpoint else {}
    if region := _first("AWS_REGION", "AWS_DEFAULT_REGION"):
        config["region"] = region
    provider = None
    if not _has_credentials("s3"):
        provider = _profile()
        config |= {} if provider is not None else {"skip_signature": True}
    return S3Store(
        bucket, config=config, client_options=_client(endpoint), retry_config=_NO_RETRY, credential_provider=provider
    )  # fmt: skip


def _profile() -> Any:  # noqa: ANN401 - obstore's provider
    """Return the credentials of a profile, or those that boto3 finds; None if there are none."""
    name = os.environ.get("AWS_PROFILE", "")
    if find_spec("boto3") is None:
        if name:
            raise UsageError(
                f"AWS_PROFILE is {name!r}; profiles need the package boto3: install it, or set AWS_ACCESS_KEY_ID and "
                "AWS_SECRET_ACCESS_KEY"
            )
        return None
    from boto3 import Session  # noqa: PLC0415 - an optional package
    from botocore.exceptions import BotoCoreError  # noqa: PLC0415
    from obstore.auth.boto3 import Boto3CredentialProvider  # noqa: PLC0415

    try:
        session = Session()
        return Boto3CredentialProvider(session) if session.get_credentials() is not None else None
    except BotoCoreError:
        raise UsageError(f"AWS_PROFILE is {name!r}; there is no such profile, or it has no valid credentials") from None


def _gs(bucket: str) -> GCSStore:
    config: Any = {} if _has_credentials("gs") or _GCLOUD.expanduser().is_file() else {"skip_signature": True}
    return GCSStore(bucket, config=config, client_options=_client(_endpoint("GOOGLE_BASE_URL")), retry_config=_NO_RETRY)


def _az(container: str) -> AzureStore:
    config: Any = {} if _has_credentials("az") else {"skip_signature": True}
    endpoint = _endpoint("AZURE_STORAGE_ENDPOINT", "AZURE_ENDPOINT")
    if os.environ.get("AZURE_STORAGE_USE_EMULATOR", "").lower() == "true":
        endpoint = endpoint or "http://127.0.0.1"  # where the emulator is
    return AzureStore(container, config=config, client_options=_client(endpoint), retry_config=_NO_RETRY)


def _has_credentials(scheme: str) -> bool:
    return any(os.environ.get(name) for name in CREDENTIALS[scheme])


def _endpoint(*names: str) -> str:
    """Return the URL in the first of some variables that is set; empty without one."""
    url = _first(*names)
    if url and not url.lower().startswith(("http://", "https://")):
        name = next(name for name in names if os.environ.get(name))
        raise UsageError(f"{name} is {url!r}; it must begin with http:// or https://")
    return url


def _first(*names: str) -> str:
    """Return the first of some variables that is set; empty without one."""
    return next((value for name in names if (value := os.environ.get(name))), "")
